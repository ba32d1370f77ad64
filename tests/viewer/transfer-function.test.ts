// SPDX-License-Identifier: Apache-2.0
import { alphaOf, curvePath, histogramPath, valueOf, xOf, yOf } from '../../viewer/src/editor/geometry';
import { presetsOf, quantile } from '../../viewer/src/presets';
import { editableOf, sceneOf, type ColorNode, type OpacityNode } from '../../viewer/src/scene';
import {
  beside, colorAt, domainOf, hexOf, movedColor, movedOpacity, opacityAt, rgbOf, withColor, without, withOpacity,
} from '../../viewer/src/transfer-function';
import { scene, volume } from '../../viewer/mock/scene';

const ramp: OpacityNode[] = [[0, 0], [10, 0.5], [20, 1]];
const colors: ColorNode[] = [[0, 0, 0, 0], [10, 1, 0.5, 0]];
const domain = [0, 20] as const;

test('TransferFunction.NodesAreJoinedLinearlyAndConstantOutside', () => {
  expect(opacityAt(ramp, 5)).toBeCloseTo(0.25, 12);
  expect(opacityAt(ramp, -3)).toBe(0);
  expect(opacityAt(ramp, 99)).toBe(1);
  expect(colorAt(colors, 5)).toEqual([0.5, 0.25, 0]);
});

test('TransferFunction.AtAStepTheLaterNodeHolds', () => {
  const step: OpacityNode[] = [[0, 0], [5, 0], [5, 1], [9, 1]];
  expect(opacityAt(step, 5)).toBe(1);
  expect(opacityAt(step, 4.999)).toBeCloseTo(0, 9);
});

test('TransferFunction.AMovedNodeDoesNotPassItsNeighboursOrTheBounds', () => {
  expect(movedOpacity(ramp, 1, 99, 2, domain)).toEqual([[0, 0], [20, 1], [20, 1]]);
  expect(movedOpacity(ramp, 0, -99, -1, domain)[0]).toEqual([0, 0]);
  expect(movedColor(colors, 0, 15, domain)[0]).toEqual([10, 0, 0, 0]);
});

test('TransferFunction.ANewColourNodeChangesNoColour', () => {
  const { nodes, index } = withColor(colors, 4);
  expect(index).toBe(1);
  for (const value of [-1, 2, 4, 7, 12]) {
    colorAt(nodes, value).forEach((c, i) => expect(c).toBeCloseTo(colorAt(colors, value)[i]!, 12));
  }
});

test('TransferFunction.NodesStayInOrderAndOneAlwaysStays', () => {
  expect(withOpacity(ramp, 15, 0.1).nodes.map(([value]) => value)).toEqual([0, 10, 15, 20]);
  expect(withOpacity(ramp, 25, 3)).toEqual({ nodes: [...ramp, [25, 1]], index: 3 });
  expect(without(ramp, 1)).toEqual([[0, 0], [20, 1]]);
  expect(without([[3, 1]], 0)).toEqual([[3, 1]]);
});

test('TransferFunction.AKeyAddsBetweenTwoNodes', () => {
  expect(beside(ramp, 0, domain)).toBe(5);
  expect(beside(ramp, 2, domain)).toBe(15);
});

test('TransferFunction.TheDomainHoldsTheRangeAndEveryNode', () => {
  expect(domainOf([5, 15], { unitDistance: 1, color: colors, opacity: ramp })).toEqual([0, 20]);
  const [low, high] = domainOf([3, 3], { unitDistance: 1, color: [[3, 0, 0, 0]], opacity: [[3, 0]] });
  expect(high).toBeGreaterThan(low);
});

test('TransferFunction.EveryDisplayColourSurvivesTheColourPicker', () => {
  for (let level = 0; level < 256; ++level) {
    const hex = `#${level.toString(16).padStart(2, '0')}00ff`;
    expect(hexOf(rgbOf(hex)!)).toBe(hex);
  }
  expect(rgbOf('red')).toBeNull();
});

test('Geometry.PlacesAndValuesAreInverse', () => {
  const plot = { width: 320, height: 150, margin: 10, domain: [-1000, 3000] } as const;
  for (const value of [-1000, -1, 700, 3000]) expect(valueOf(plot, xOf(plot, value))).toBeCloseTo(value, 6);
  for (const alpha of [0, 0.01, 0.5, 1]) expect(alphaOf(plot, yOf(plot, alpha))).toBeCloseTo(alpha, 9);
  expect(alphaOf(plot, -50)).toBe(1);
  expect(alphaOf(plot, 500)).toBe(0);
});

test('Geometry.PathsHoldNoNumberThatIsNone', () => {
  const plot = { width: 0, height: 0, margin: 10, domain: [0, 1] } as const;
  expect(curvePath(plot, [[0.5, 1]])).not.toMatch(/NaN|Infinity/);
  expect(histogramPath(plot, [0, -5, 1e300], [0, 1])).not.toMatch(/NaN|Infinity/);
  expect(histogramPath(plot, [], [0, 1])).toBe('');
});

test('Presets.EachIsASceneThatDecodes', () => {
  const own = sceneOf(scene, 'scene').editable;
  const empty = { ...volume, histogram: new Array<number>(256).fill(0), range: [7, 7] };
  for (const data of [volume, empty]) {
    for (const { look } of presetsOf(data as never, own.volume)) {
      const round = editableOf({ ...own, volume: { ...own.volume, ...look } }, 'preset');
      expect(round.volume.transferFunction).toEqual(look.transferFunction);
      expect(round.volume.transferFunction.unitDistance).toBeGreaterThan(0);
    }
  }
});

test('Presets.QuantilesIgnoreTheBackground', () => {
  const histogram = [1e6, 0, 0, 0, 10, 10, 10, 10];
  const data = { range: [0, 80] as const, histogram };
  expect(quantile(data, 0.01)).toBe(45);
  expect(quantile(data, 1)).toBe(75);
  expect(quantile(data, 0.5)).toBe(55);
});

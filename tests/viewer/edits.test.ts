// SPDX-License-Identifier: Apache-2.0
import { Edits } from '../../viewer/src/edits';
import { Flow } from '../../viewer/src/flow';
import { History } from '../../viewer/src/history';
import { applied, difference, merged, sceneOf, type Editable } from '../../viewer/src/scene';
import { scene } from '../../viewer/mock/scene';

const base: Editable = sceneOf(scene, 'scene').editable;

test('Scene.ADifferenceAppliedGivesTheOtherState', () => {
  const other: Editable = { ...base, step: 3, volume: { ...base.volume, mode: 'mip', shading: null } };
  expect(applied(base, difference(base, other))).toEqual(other);
  expect(difference(base, base)).toEqual({});
  expect(difference(base, other)).toEqual({ step: 3, volume: { mode: 'mip', shading: null } });
});

test('Scene.AMergedEditDoesWhatBothDo', () => {
  const first = { step: 1, volume: { mode: 'mip' as const } };
  const second = { step: 2, volume: { shading: null } };
  expect(applied(base, merged(first, second))).toEqual(applied(applied(base, first), second));
});

test('Edits.AnEditIsShownAtOnceAndSentOnce', () => {
  const edits = new Edits(base);
  edits.edit({ step: 5 }, 'step');
  expect(edits.shown.step).toBe(5);
  expect(edits.take(1)).toEqual({ step: 5 });
  expect(edits.take(2)).toBeNull();
  expect(edits.shown.step).toBe(5);
});

test('Edits.ARefusedEditVanishesAndNamesItsControl', () => {
  const edits = new Edits(base);
  edits.edit({ step: -1 }, 'step');
  edits.take(1);
  edits.edit({ background: [1, 1, 1] }, 'background');
  edits.take(2);
  expect(edits.refuse(1)).toBe('step');
  expect(edits.shown).toEqual({ ...base, background: [1, 1, 1] });
});

test('Edits.TheServersWordWinsOnceItHasAnswered', () => {
  const edits = new Edits(base);
  edits.edit({ step: 5 }, 'step');
  edits.take(1);
  edits.confirm({ ...base, step: 4 }, 1);
  expect(edits.shown.step).toBe(4);
});

test('Edits.ALaterEditStaysOnTopOfAnEarlierAnswer', () => {
  const edits = new Edits(base);
  edits.edit({ step: 5 }, 'step');
  edits.take(1);
  edits.edit({ step: 6 }, 'step');
  edits.take(2);
  edits.confirm({ ...base, step: 5 }, 1);
  expect(edits.shown.step).toBe(6);
  edits.confirm({ ...base, step: 6 }, 2);
  expect(edits.shown.step).toBe(6);
});

test('Flow.TwoUnansweredInputsHoldTheNextBack', () => {
  const flow = new Flow();
  expect(flow.mayFlow(0)).toBe(true);
  expect(flow.next(0, 0)).toBe(1);
  expect(flow.mayFlow(0)).toBe(true);
  expect(flow.next(5, 6)).toBe(2);
  expect(flow.mayFlow(10)).toBe(false);
  expect(flow.answered(1, 40)).toBe(40);
  expect(flow.mayFlow(41)).toBe(true);
});

test('Flow.APictureAnswersAllOlderInputsAndMeasuresItsOwn', () => {
  const flow = new Flow();
  flow.next(0, 1);
  flow.next(10, 11);
  expect(flow.answered(2, 60)).toBe(50);
  expect(flow.unanswered).toBe(0);
  expect(flow.answered(2, 90)).toBeNull();
});

test('Flow.AnInputThatIsNeverAnsweredBlocksForABoundedTime', () => {
  const flow = new Flow();
  flow.next(0, 0);
  flow.next(0, 0);
  expect(flow.mayFlow(900)).toBe(false);
  expect(flow.mayFlow(1100)).toBe(true);
});

test('Flow.AnInputThatNeedsNoPictureDoesNotBlock', () => {
  const flow = new Flow();
  flow.next(0, 0);
  flow.next(0, 0);
  flow.settled(2);
  expect(flow.mayFlow(1)).toBe(true);
});

const numbers = (): History<number> => new History((a, b) => a === b);

test('History.UndoAndRedoAreInverse', () => {
  const history = numbers();
  history.record(1, 'a', 0);
  history.record(2, 'b', 10);
  expect(history.undo(3)).toBe(2);
  expect(history.undo(2)).toBe(1);
  expect(history.undo(1)).toBeNull();
  expect(history.redo(1)).toBe(2);
  expect(history.redo(2)).toBe(3);
  expect(history.redo(3)).toBeNull();
});

test('History.ADragIsOneStep', () => {
  const history = numbers();
  for (let i = 0; i < 50; ++i) history.record(i, 'opacity', i * 16);
  expect(history.undo(50)).toBe(0);
});

test('History.ANewEditForgetsTheRedo', () => {
  const history = numbers();
  history.record(1, 'a', 0);
  history.undo(2);
  history.record(1, 'b', 10);
  expect(history.canRedo).toBe(false);
});

test('History.StepsThatMakeNoDifferenceAreSkipped', () => {
  const history = numbers();
  history.record(1, 'a', 0);
  history.record(5, 'b', 5000);
  expect(history.undo(5)).toBe(1);
});

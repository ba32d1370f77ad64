// SPDX-License-Identifier: Apache-2.0
import { decodeMessage } from '../../viewer/src/protocol';
import { scene, volume } from '../../viewer/mock/scene';

const welcome = {
  type: 'welcome', protocol: 2, version: '0.1.0', viewer: 2, driver: 1, viewers: 2, sizeFixed: true, scene, volume,
  display: { filter: 'box', update: 'frameless', cine: true },
};
const status = {
  type: 'status', epoch: 4, step: 9, samplesPerPixel: 2.5, converged: 0.25, target: 0.5, estimatedError: 1.5, spatialError: 0.7,
  temporalError: null, phase: 'refining', framesPerSecond: 12, rays: 1e6, seconds: 0.5, features: ['shading'], kernel: 'AVX2',
  ranks: [{ rank: 0, role: 'master', host: 'a', state: 'idle', busy: 0.5, tiles: 3 }],
};

const decoded = (message: unknown) => decodeMessage(JSON.stringify(message));
const without = (message: object, key: string): object =>
  Object.fromEntries(Object.entries(message).filter(([name]) => name !== key));

test('Protocol.AWelcomeGivesTheSceneAndTheVolume', () => {
  const message = decoded(welcome);
  if (!message.ok || message.value.type !== 'welcome') throw new Error('not a welcome');
  expect(message.value).toMatchObject({ viewer: 2, driver: 1, sizeFixed: true });
  expect(message.value.scene.editable.volume.transferFunction.opacity).toHaveLength(6);
  expect(message.value.scene.camera.fovy).toBe(30);
  expect(message.value.volume.histogram).toHaveLength(256);
});

test('Protocol.EveryTypeOfTheDocumentIsKnown', () => {
  const failure = { where: 'a', what: 'b', mend: 'c' };
  for (const message of [
    welcome, status, { type: 'loading', what: 'x', done: 1, total: 2 }, { type: 'driver', driver: 1, viewers: 2 },
    { type: 'view', camera: scene.camera, width: 3, height: 4 }, { type: 'scene', scene, viewer: 1, serial: 2 },
    { type: 'display', filter: 'bicubic', update: '50', cine: false, viewer: 1, serial: 2 },
    { type: 'refused', serial: 3, ...failure }, { type: 'failed', ...failure }, { type: 'pong', time: 1.5 },
  ]) expect(decoded(message), message.type).toMatchObject({ ok: true, value: { type: message.type } });
});

test('Protocol.ADisplayTellsWhoChoseIt', () => {
  const display = { filter: 'piecewise-quadratic', update: '25', cine: true };
  expect(decoded({ type: 'display', ...display, viewer: 3, serial: 7 }))
    .toEqual({ ok: true, value: { type: 'display', display, viewer: 3, serial: 7 } });
  expect(decoded({ type: 'display', ...display, filter: 'sinc' }).ok).toBe(false);
  expect(decoded({ type: 'display', ...display, update: 50 }).ok).toBe(false);
  expect(decoded({ type: 'display', ...display, cine: 1 }).ok).toBe(false);
  expect(decoded(welcome)).toMatchObject({ value: { display: welcome.display } });
});

test('Protocol.WhatIsNotEstimatedIsNull', () => {
  expect(decoded(status)).toMatchObject({ value: { estimatedError: 1.5, spatialError: 0.7, temporalError: null, phase: 'refining' } });
  expect(decoded({ ...status, estimatedError: null })).toMatchObject({ value: { estimatedError: null } });
  expect(decoded({ ...status, phase: 'waiting' }).ok).toBe(false);
});

test('Protocol.AMissingFieldIsNamed', () => {
  expect(decoded(without(welcome, 'scene'))).toEqual({ ok: false, problem: 'scene: an object expected' });
  expect(decoded(without(welcome, 'display'))).toEqual({ ok: false, problem: 'display: an object expected' });
  expect(decoded(without(welcome, 'viewer'))).toEqual({ ok: false, problem: 'viewer: a count expected' });
  expect(decoded({ ...welcome, volume: { ...volume, range: [0] } }))
    .toEqual({ ok: false, problem: 'volume.range: 2 numbers expected' });
  expect(decoded({ ...status, ranks: [{ ...status.ranks[0], state: 'gone' }] }))
    .toEqual({ ok: false, problem: 'ranks[0].state: busy or idle or lost expected' });
});

test('Protocol.AnotherProtocolIsRefused', () => {
  const message = decoded({ ...welcome, protocol: 1 });
  expect(!message.ok && message.problem).toContain('protocol 1');
});

test('Protocol.UnsortedNodesAreRefused', () => {
  const bad = structuredClone(scene);
  bad.volumes[0]!.transferFunction.opacity.reverse();
  expect(decoded({ ...welcome, scene: bad }).ok).toBe(false);
});

test('Protocol.HostileTextGivesAProblemAndNeverThrows', () => {
  for (const text of ['', '{', 'null', '[]', '1', '{"type":7}', '{"type":"__proto__"}', '{"type":"constructor"}',
    '{"type":"toString"}', '{"type":"view","camera":{"position":[1,2]}}', '{"type":"pong","time":1e999}']) {
    expect(decodeMessage(text).ok, text).toBe(false);
  }
});

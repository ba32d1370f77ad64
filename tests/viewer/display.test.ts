// SPDX-License-Identifier: Apache-2.0
import { DisplayChoice, kDefaultDisplay, type Display } from '../../viewer/src/display';

const bicubic: Display = { ...kDefaultDisplay, filter: 'bicubic' };

test('DisplayChoice.AChoiceIsShownAtOnceAndSentOnce', () => {
  const choice = new DisplayChoice();
  expect(choice.choose({ filter: 'bicubic' })).toBe(true);
  expect(choice.shown).toEqual(bicubic);
  expect(choice.waiting).toBe(true);
  expect(choice.take(1)).toEqual(bicubic);
  expect(choice.waiting).toBe(false);
  expect(choice.shown).toEqual(bicubic);
});

test('DisplayChoice.WhatIsChosenAlreadyIsNoChoice', () => {
  const choice = new DisplayChoice();
  expect(choice.choose({ cine: false })).toBe(false);
  expect(choice.waiting).toBe(false);
});

test('DisplayChoice.TheServersWordWinsOnceItHasAnswered', () => {
  const choice = new DisplayChoice();
  choice.choose({ filter: 'bicubic' });
  choice.take(1);
  choice.confirm({ ...kDefaultDisplay, filter: 'box' }, 1);
  expect(choice.shown.filter).toBe('box');
});

test('DisplayChoice.ALaterChoiceStaysOnTopOfAnEarlierAnswer', () => {
  const choice = new DisplayChoice();
  choice.choose({ filter: 'bicubic' });
  choice.take(1);
  choice.choose({ cine: true });
  choice.confirm(bicubic, 1);
  expect(choice.shown).toEqual({ ...bicubic, cine: true });
  choice.take(2);
  choice.confirm(kDefaultDisplay, 0);
  expect(choice.shown).toEqual({ ...bicubic, cine: true });
  choice.confirm({ ...bicubic, cine: true }, 2);
  expect(choice.shown).toEqual({ ...bicubic, cine: true });
});

test('DisplayChoice.ARefusedOrDroppedChoiceVanishes', () => {
  const choice = new DisplayChoice();
  choice.confirm(bicubic, 0);
  choice.choose({ update: '25' });
  choice.take(4);
  expect(choice.refuse(3)).toBe(false);
  expect(choice.refuse(4)).toBe(true);
  expect(choice.shown).toEqual(bicubic);
  expect(choice.refuse(4)).toBe(false);
  choice.choose({ update: '50' });
  choice.drop();
  expect(choice.shown).toEqual(bicubic);
  expect(choice.waiting).toBe(false);
});

test('DisplayChoice.AWatcherFollows', () => {
  const choice = new DisplayChoice();
  for (const cine of [true, false, true]) {
    choice.confirm({ ...bicubic, cine }, 0);
    expect(choice.shown).toEqual({ ...bicubic, cine });
  }
});

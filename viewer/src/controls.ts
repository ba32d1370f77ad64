// SPDX-License-Identifier: Apache-2.0
// Labelled controls. Each shows a value that is set from outside and reports what the user makes of
// it; setting a value never reports, and never disturbs a field that is being typed into.

import { el, shown } from './dom';
import { hexOf, rgbOf } from './transfer-function';
import type { Vec3 } from './vector';

export interface Control<T> {
  readonly element: HTMLElement;
  show(value: T): void;
}

interface NumberOptions {
  readonly low?: number;
  readonly high?: number;
  /** With a slider over [low, high]. */
  readonly slider?: boolean;
  readonly unit?: string;
}

/** A bare number input that reports a finite, bounded number when it is committed. */
export function numberInput(label: string, options: NumberOptions, report: (value: number) => void):
  { input: HTMLInputElement; show: (value: number) => void } {
  const { low = -Infinity, high = Infinity } = options;
  const input = el('input', { type: 'text', inputMode: 'decimal', class: 'number', aria: { label }, autocomplete: 'off' });
  let last = 0;
  let typing = false;
  const show = (value: number): void => { last = value; typing = false; input.value = shown(value, 6); };
  const commit = (): void => {
    const value = Number(input.value.replace(',', '.'));
    if (input.value.trim() === '' || !Number.isFinite(value)) return show(last);
    const bounded = Math.min(Math.max(value, low), high);
    if (shown(bounded, 6) === shown(last, 6)) return show(last);
    show(bounded);
    report(bounded);
  };
  input.addEventListener('input', () => { typing = true; });
  input.addEventListener('change', commit);
  input.addEventListener('keydown', (event) => {
    if (event.key === 'Escape') show(last);
    if (event.key !== 'ArrowUp' && event.key !== 'ArrowDown') return;
    event.preventDefault();
    const span = Number.isFinite(high - low) ? high - low : Math.max(Math.abs(last), 1);
    const stride = (span / 100) * (event.shiftKey ? 0.1 : 1) * (event.key === 'ArrowUp' ? 1 : -1);
    input.value = shown(last + stride, 6);
    commit();
  });
  return { input, show: (value) => { if (typing) last = value; else show(value); } };
}

export function numberField(label: string, options: NumberOptions, report: (value: number) => void): Control<number> {
  const number = numberInput(label, options, (value) => { if (range) range.value = String(value); report(value); });
  const range = options.slider
    ? el('input', { type: 'range', min: String(options.low), max: String(options.high), step: 'any', aria: { label } })
    : null;
  range?.addEventListener('input', () => {
    const value = Number(Number(range.value).toPrecision(4));
    number.show(value);
    report(value);
  });
  const unit = options.unit ? el('span', { class: 'unit' }, options.unit) : null;
  return {
    element: el('div', { class: range ? 'row slider' : 'row' }, el('span', { class: 'label' }, label), range,
      el('span', { class: 'entry' }, number.input, unit)),
    show: (value) => {
      number.show(value);
      if (range && !range.matches(':active')) range.value = String(value);
    },
  };
}

export function selectField<T extends string>(label: string, choices: readonly (readonly [T, string])[],
  report: (value: T) => void): Control<T> {
  const select = el('select', {}, ...choices.map(([value, name]) => el('option', { value }, name)));
  select.addEventListener('change', () => report(select.value as T));
  return {
    element: el('label', { class: 'row' }, el('span', { class: 'label' }, label), select),
    show: (value) => { select.value = value; },
  };
}

export function checkField(label: string, report: (value: boolean) => void): Control<boolean> {
  const box = el('input', { type: 'checkbox' });
  box.addEventListener('change', () => report(box.checked));
  return {
    element: el('label', { class: 'row check' }, box, el('span', {}, label)),
    show: (value) => { box.checked = value; },
  };
}

export function colorInput(label: string, report: (rgb: Vec3) => void): Control<Vec3> {
  const input = el('input', { type: 'color', aria: { label }, title: label });
  input.addEventListener('input', () => {
    const rgb = rgbOf(input.value);
    if (rgb) report(rgb);
  });
  return { element: input, show: (rgb) => { input.value = hexOf(rgb); } };
}

export function colorField(label: string, report: (rgb: Vec3) => void): Control<Vec3> {
  const color = colorInput(label, report);
  return {
    element: el('label', { class: 'row' }, el('span', { class: 'label' }, label), color.element),
    show: color.show,
  };
}

export function vectorField(label: string, report: (value: Vec3) => void): Control<Vec3> {
  let current: Vec3 = [0, 0, 0];
  const parts = ['x', 'y', 'z'].map((axis, i) => numberInput(`${label} ${axis}`, {}, (value) => {
    current = current.map((old, j) => (i === j ? value : old)) as unknown as Vec3;
    report(current);
  }));
  return {
    element: el('div', { class: 'row' }, el('span', { class: 'label' }, label),
      el('span', { class: 'vector' }, ...parts.map(({ input }) => input))),
    show: (value) => {
      current = value;
      parts.forEach((part, i) => part.show(value[i]!));
    },
  };
}

/** One choice of few, all visible. */
export function segmented<T extends string>(label: string, choices: readonly (readonly [T, string, string])[],
  report: (value: T) => void): Control<T> {
  const name = `choice-${label.toLowerCase().replaceAll(' ', '-')}`;
  const radios = choices.map(([value]) => el('input', { type: 'radio', name, value }));
  const options = choices.map(([value, text, hint], i) => {
    radios[i]!.addEventListener('change', () => report(value));
    return el('label', { title: hint }, radios[i]!, el('span', {}, text));
  });
  return {
    element: el('div', { class: 'segmented', role: 'radiogroup', aria: { label } }, ...options),
    show: (value) => { for (const radio of radios) radio.checked = radio.value === value; },
  };
}

export function button(text: string, hint: string, press: () => void, style = ''): HTMLButtonElement {
  const element = el('button', { type: 'button', title: hint, class: style }, text);
  if (text.length <= 2) element.setAttribute('aria-label', hint);
  element.addEventListener('click', press);
  return element;
}

export function section(title: string, open: boolean, ...children: (Node | null)[]): HTMLDetailsElement {
  return el('details', { class: 'section', open }, el('summary', {}, el('h2', {}, title)),
    el('div', { class: 'body' }, ...children));
}

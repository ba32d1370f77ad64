// SPDX-License-Identifier: Apache-2.0
// Decoders of untrusted JSON. Each checks one value and throws a DecodeError that names the field;
// nothing outside this file and its callers' one catch ever sees the exception.

import type { Vec3 } from './vector';

export class DecodeError extends Error {}

export type Decoder<T> = (value: unknown, where: string) => T;

function bad(where: string, wanted: string): never {
  throw new DecodeError(`${where}: ${wanted} expected`);
}

export const number: Decoder<number> = (value, where) =>
  typeof value === 'number' && Number.isFinite(value) ? value : bad(where, 'a finite number');

export const positive: Decoder<number> = (value, where) => {
  const known = number(value, where);
  return known > 0 ? known : bad(where, 'a positive number');
};

export const count: Decoder<number> = (value, where) =>
  typeof value === 'number' && Number.isSafeInteger(value) && value >= 0 ? value : bad(where, 'a count');

export const boolean: Decoder<boolean> = (value, where) =>
  typeof value === 'boolean' ? value : bad(where, 'true or false');

/** Text of at most 4096 characters; longer text is cut, since it is only ever shown. */
export const text: Decoder<string> = (value, where) =>
  typeof value === 'string' ? value.slice(0, 4096) : bad(where, 'text');

export const record: Decoder<Record<string, unknown>> = (value, where) =>
  typeof value === 'object' && value !== null && !Array.isArray(value)
    ? (value as Record<string, unknown>)
    : bad(where, 'an object');

export const list = <T>(item: Decoder<T>, most = 4096): Decoder<T[]> => (value, where) => {
  if (!Array.isArray(value) || value.length > most) bad(where, `a list of at most ${most}`);
  return value.map((entry, i) => item(entry, `${where}[${i}]`));
};

export const oneOf = <T extends string>(...names: T[]): Decoder<T> => (value, where) =>
  names.includes(value as T) ? (value as T) : bad(where, names.join(' or '));

export const optional = <T>(item: Decoder<T>, absent: T): Decoder<T> => (value, where) =>
  value === undefined || value === null ? absent : item(value, where);

export const numbers = (size: number): Decoder<number[]> => (value, where) => {
  const all = list(number, size)(value, where);
  return all.length === size ? all : bad(where, `${size} numbers`);
};

export const vec3: Decoder<Vec3> = (value, where) => numbers(3)(value, where) as unknown as Vec3;

/** Reads the fields of `value` one by one: `at('name', decoder)`. */
export function fields(value: unknown, where: string): <T>(name: string, item: Decoder<T>) => T {
  const object = record(value, where);
  return (name, item) => item(object[name], where === '' ? name : `${where}.${name}`);
}

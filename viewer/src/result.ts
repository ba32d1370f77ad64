// SPDX-License-Identifier: Apache-2.0
// A value, or why there is none.

export type Result<T> = { readonly ok: true; readonly value: T } | { readonly ok: false; readonly problem: string };

export const success = <T>(value: T): Result<T> => ({ ok: true, value });
export const failure = <T = never>(problem: string): Result<T> => ({ ok: false, problem });

// SPDX-License-Identifier: Apache-2.0
// A link that carries a look: camera and edits as base64url of JSON in the address's hash. It never
// carries the access token unless asked to, since who holds the token can use the cluster.

import * as decode from './decode';
import { isUsable, type Camera } from './camera';
import { failure, success, type Result } from './result';
import { cameraOf, editableOf, type Editable } from './scene';

export interface Look {
  readonly camera: Camera;
  readonly editable: Editable;
}

const kPrefix = '#look=';
const kMaxLength = 65536;

/** Nine digits: less than a pixel at any zoom, and half the length. */
const shortened = (_key: string, value: unknown): unknown =>
  typeof value === 'number' ? Number(value.toPrecision(9)) : value;

export function hashOf(look: Look): string {
  const bytes = new TextEncoder().encode(JSON.stringify({ v: 1, ...look }, shortened));
  const binary = Array.from(bytes, (byte) => String.fromCharCode(byte)).join('');
  return kPrefix + btoa(binary).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
}

/** The look in an address's hash; null if the hash is not one of ours. */
export function lookOf(hash: string): Result<Look> | null {
  if (!hash.startsWith(kPrefix)) return null;
  if (hash.length > kMaxLength) return failure('the link is too long');
  try {
    const binary = atob(hash.slice(kPrefix.length).replaceAll('-', '+').replaceAll('_', '/'));
    const bytes = Uint8Array.from(binary, (char) => char.charCodeAt(0));
    const at = decode.fields(JSON.parse(new TextDecoder().decode(bytes)), 'link');
    if (at('v', decode.count) !== 1) return failure('the link was made by another version');
    const look = { camera: at('camera', cameraOf), editable: at('editable', editableOf) };
    return isUsable(look.camera) ? success(look) : failure('the link holds no usable camera');
  } catch (error) {
    return failure(error instanceof decode.DecodeError ? error.message : 'the link is damaged');
  }
}

/** The address to share. */
export function linkOf(page: string, look: Look, withToken: boolean): string {
  const url = new URL(page);
  if (!withToken) url.searchParams.delete('token');
  url.hash = hashOf(look);
  return url.href;
}

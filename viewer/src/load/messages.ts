// SPDX-License-Identifier: Apache-2.0
// How the work is spread, as the gateway tells it to a page that watches ("load" and "tiles" of
// docs/viewer-protocol.md).

import * as decode from '../decode';

/** What this page wants to be told beside the picture. */
export interface Watch {
  readonly load: boolean;
  readonly tiles: boolean;
}

export interface RankLoad {
  readonly rank: number;
  readonly role: string;
  readonly lost: boolean;
  /** Part of the last second that each of its threads computed, 0 … 1. */
  readonly busy: number;
  /** Seconds of each of a worker's threads on the newest whole view; null of other ranks. */
  readonly view: number | null;
  /** The same as `busy` for each bin of the last seconds, oldest first. */
  readonly share: readonly number[];
  /** How long ago the newest bin ended, and how much that may be wrong, in ms. */
  readonly age: number;
  readonly error: number;
}

export interface Traffic {
  readonly kind: string;
  readonly messages: number;
  /** Bytes since the start, and in the last second. */
  readonly total: number;
  readonly perSecond: number;
}

export interface Load {
  /** Length of a bin in ms. */
  readonly bin: number;
  readonly ranks: readonly RankLoad[];
  readonly bytes: readonly Traffic[];
}

export interface Tile {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
  /** Who cast it last. */
  readonly rank: number;
  /** What its threads spent on it, in ms. */
  readonly cost: number;
}

export interface Tiles {
  readonly epoch: number;
  /** The image, in pixels. */
  readonly width: number;
  readonly height: number;
  /** A whole tile, in pixels. */
  readonly tile: readonly [number, number];
  readonly tiles: readonly Tile[];
}

const kDigits = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_';
const kMostTiles = 1 << 18;
const kFieldsOfTile = 6;

const shareOf: decode.Decoder<number[]> = (value, where) =>
  [...decode.text(value, where)].map((digit) => {
    const share = kDigits.indexOf(digit);
    if (share < 0) throw new decode.DecodeError(`${where}: digits of base64url expected`);
    return share / 63;
  });

const rankOf: decode.Decoder<RankLoad> = (value, where) => {
  const at = decode.fields(value, where);
  return {
    rank: at('rank', decode.count),
    role: at('role', decode.text),
    lost: at('lost', decode.optional(decode.boolean, false)),
    busy: at('busy', decode.number),
    view: at('view', decode.optional<number | null>(decode.number, null)),
    share: at('share', shareOf),
    age: at('age', decode.number),
    error: at('error', decode.number),
  };
};

const trafficOf: decode.Decoder<Traffic> = (value, where) => {
  const at = decode.fields(value, where);
  return {
    kind: at('kind', decode.text),
    messages: at('messages', decode.count),
    total: at('total', decode.count),
    perSecond: at('perSecond', decode.number),
  };
};

type At = ReturnType<typeof decode.fields>;

export const loadFrom = (at: At): { load: Load } => ({
  load: {
    bin: at('bin', decode.positive),
    ranks: at('ranks', decode.list(rankOf, 65536)),
    bytes: at('bytes', decode.list(trafficOf, 1024)),
  },
});

export const tilesFrom = (at: At): { tiles: Tiles } => {
  const flat = at('tiles', decode.list(decode.number, kFieldsOfTile * kMostTiles));
  if (flat.length % kFieldsOfTile !== 0) throw new decode.DecodeError(`tiles: ${kFieldsOfTile} numbers for each expected`);
  const tiles = Array.from({ length: flat.length / kFieldsOfTile }, (_, i) => {
    const [x, y, width, height, rank, cost] = flat.slice(kFieldsOfTile * i, kFieldsOfTile * (i + 1)) as [number, number, number, number, number, number];
    return { x, y, width, height, rank, cost };
  });
  return {
    tiles: {
      epoch: at('epoch', decode.count),
      width: at('width', decode.positive),
      height: at('height', decode.positive),
      tile: at('tile', decode.numbers(2)) as [number, number],
      tiles,
    },
  };
};

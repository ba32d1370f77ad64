// SPDX-License-Identifier: Apache-2.0
// What page and gateway say to each other (docs/viewer-protocol.md): the types of all messages and
// the strict decoder of the gateway's. A message that does not decode changes nothing.

import * as decode from './decode';
import { type Camera } from './camera';
import { displayFrom, displayOf, type Display } from './display';
import { loadFrom, tilesFrom, type Load, type Tiles, type Watch } from './load/messages';
import { failure, success, type Result } from './result';
import { cameraOf, sceneOf, type Edit, type SceneState } from './scene';
import type { Vec3 } from './vector';

export const kProtocol = 2;

export type ToGateway =
  | { type: 'hello'; protocol: number }
  | { type: 'camera'; serial: number; camera: Camera }
  | { type: 'edit'; serial: number; edit: Edit }
  | { type: 'size'; serial: number; width: number; height: number }
  | ({ type: 'display'; serial: number } & Display)
  | { type: 'drive' }
  | ({ type: 'watch' } & Watch)
  | { type: 'ack'; picture: number }
  | { type: 'ping'; time: number };

export interface VolumeInfo {
  readonly name: string;
  readonly size: Vec3;
  readonly spacing: Vec3;
  readonly type: string;
  readonly range: readonly [number, number];
  readonly histogram: readonly number[];
  readonly center: Vec3;
  readonly radius: number;
}

export interface RankStatus {
  readonly rank: number;
  readonly role: string;
  readonly host: string;
  readonly state: 'busy' | 'idle' | 'lost';
  readonly busy: number;
  readonly tiles: number;
}

export type Phase = 'moving' | 'refining' | 'converged' | 'cine';

export interface Status {
  readonly epoch: number;
  /** Steps of refinement that each part of the picture has taken. */
  readonly step: number;
  readonly samplesPerPixel: number;
  readonly converged: number;
  /** The error to get to, in 1/255. */
  readonly target: number;
  /** Root mean square in 1/255. */
  readonly estimatedError: number | null;
  /** In pixels. */
  readonly spatialError: number | null;
  readonly temporalError: number | null;
  readonly phase: Phase;
  readonly framesPerSecond: number;
  readonly rays: number;
  readonly seconds: number;
  readonly features: readonly string[];
  readonly kernel: string;
  readonly ranks: readonly RankStatus[];
}

export interface Failure {
  readonly where: string;
  readonly what: string;
  readonly mend: string;
}

export interface Welcome {
  readonly type: 'welcome';
  readonly version: string;
  readonly viewer: number;
  readonly driver: number;
  readonly viewers: number;
  readonly sizeFixed: boolean;
  readonly scene: SceneState;
  readonly volume: VolumeInfo;
  readonly display: Display;
}

export type FromGateway =
  | Welcome
  | { readonly type: 'loading'; readonly what: string; readonly done: number; readonly total: number }
  | { readonly type: 'driver'; readonly driver: number; readonly viewers: number }
  | { readonly type: 'view'; readonly camera: Camera; readonly width: number; readonly height: number }
  | { readonly type: 'scene'; readonly scene: SceneState; readonly viewer: number; readonly serial: number }
  | { readonly type: 'display'; readonly display: Display; readonly viewer: number; readonly serial: number }
  | ({ readonly type: 'refused'; readonly serial: number } & Failure)
  | ({ readonly type: 'status' } & Status)
  | { readonly type: 'load'; readonly load: Load }
  | { readonly type: 'tiles'; readonly tiles: Tiles }
  | ({ readonly type: 'failed' } & Failure)
  | { readonly type: 'pong'; readonly time: number };

type At = ReturnType<typeof decode.fields>;

function failureOf(at: At): Failure {
  const text = decode.optional(decode.text, '');
  return { where: at('where', text), what: at('what', decode.text), mend: at('mend', text) };
}

const volumeOf: decode.Decoder<VolumeInfo> = (value, where) => {
  const at = decode.fields(value, where);
  const range = at('range', decode.numbers(2)) as [number, number];
  return {
    name: at('name', decode.text),
    size: at('size', decode.vec3),
    spacing: at('spacing', decode.vec3),
    type: at('type', decode.text),
    range: range[0] <= range[1] ? range : [range[1], range[0]],
    histogram: at('histogram', decode.list(decode.number, 65536)),
    center: at('center', decode.vec3),
    radius: at('radius', decode.number),
  };
};

const rankOf: decode.Decoder<RankStatus> = (value, where) => {
  const at = decode.fields(value, where);
  return {
    rank: at('rank', decode.count),
    role: at('role', decode.text),
    host: at('host', decode.optional(decode.text, '')),
    state: at('state', decode.oneOf('busy', 'idle', 'lost')),
    busy: at('busy', decode.optional(decode.number, 0)),
    tiles: at('tiles', decode.optional(decode.number, 0)),
  };
};

/** Who asked for a change, and by which of its inputs. */
const causeOf = (at: At): { viewer: number; serial: number } => ({
  viewer: at('viewer', decode.optional(decode.count, 0)),
  serial: at('serial', decode.optional(decode.count, 0)),
});

const statusOf = (at: At): Status => {
  const estimate = decode.optional<number | null>(decode.number, null);
  return {
    epoch: at('epoch', decode.count),
    step: at('step', decode.count),
    samplesPerPixel: at('samplesPerPixel', decode.number),
    converged: at('converged', decode.number),
    target: at('target', decode.number),
    estimatedError: at('estimatedError', estimate),
    spatialError: at('spatialError', estimate),
    temporalError: at('temporalError', estimate),
    phase: at('phase', decode.oneOf('moving', 'refining', 'converged', 'cine')),
    framesPerSecond: at('framesPerSecond', decode.optional(decode.number, 0)),
    rays: at('rays', decode.optional(decode.number, 0)),
    seconds: at('seconds', decode.optional(decode.number, 0)),
    features: at('features', decode.optional(decode.list(decode.text, 64), [] as string[])),
    kernel: at('kernel', decode.optional(decode.text, '')),
    ranks: at('ranks', decode.optional(decode.list(rankOf, 65536), [] as RankStatus[])),
  };
};

const decoders: { [K in FromGateway['type']]: (at: At) => Omit<Extract<FromGateway, { type: K }>, 'type'> } = {
  welcome: (at) => {
    const protocol = at('protocol', decode.count);
    if (protocol !== kProtocol) {
      throw new decode.DecodeError(`the server speaks protocol ${protocol}, this page ${kProtocol}; reload the page`);
    }
    return {
      version: at('version', decode.text),
      viewer: at('viewer', decode.count),
      driver: at('driver', decode.count),
      viewers: at('viewers', decode.count),
      sizeFixed: at('sizeFixed', decode.optional(decode.boolean, false)),
      scene: at('scene', sceneOf),
      volume: at('volume', volumeOf),
      display: at('display', displayOf),
    };
  },
  loading: (at) => ({
    what: at('what', decode.text),
    done: at('done', decode.optional(decode.number, 0)),
    total: at('total', decode.optional(decode.number, 0)),
  }),
  driver: (at) => ({ driver: at('driver', decode.count), viewers: at('viewers', decode.count) }),
  view: (at) => ({
    camera: at('camera', cameraOf), width: at('width', decode.count), height: at('height', decode.count),
  }),
  scene: (at) => ({ scene: at('scene', sceneOf), ...causeOf(at) }),
  display: (at) => ({ display: displayFrom(at), ...causeOf(at) }),
  refused: (at) => ({ serial: at('serial', decode.optional(decode.count, 0)), ...failureOf(at) }),
  status: statusOf,
  load: loadFrom,
  tiles: tilesFrom,
  failed: failureOf,
  pong: (at) => ({ time: at('time', decode.number) }),
};

/** The message in `json`, or what is wrong with it. */
export function decodeMessage(json: string): Result<FromGateway> {
  try {
    const value: unknown = JSON.parse(json);
    const at = decode.fields(value, '');
    const type = at('type', decode.text);
    if (!Object.hasOwn(decoders, type)) return failure(`unknown message "${type.slice(0, 40)}"`);
    const known = type as FromGateway['type'];
    return success({ type: known, ...decoders[known](at) } as FromGateway);
  } catch (error) {
    return failure(error instanceof decode.DecodeError ? error.message : 'a message that is not JSON');
  }
}

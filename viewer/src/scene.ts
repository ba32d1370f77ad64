// SPDX-License-Identifier: Apache-2.0
// The part of a scene that the page shows and edits: values in the scene file's own words and
// units. An `Editable` is complete; an `Edit` holds only what changes.

import * as decode from './decode';
import type { Camera } from './camera';
import type { Vec3 } from './vector';

export type Mode = 'dvr' | 'isosurface' | 'mip';

export interface Shading {
  readonly ambient: number;
  readonly diffuse: number;
  readonly specular: number;
  readonly shininess: number;
}

/** value, red, green, blue; colours 0 … 1. */
export type ColorNode = readonly [number, number, number, number];
/** value, opacity 0 … 1. */
export type OpacityNode = readonly [number, number];

export interface TransferFunction {
  /** The length in millimetres over which an opacity is reached. */
  readonly unitDistance: number;
  readonly color: readonly ColorNode[];
  readonly opacity: readonly OpacityNode[];
}

export interface Isosurface {
  readonly value: number;
  readonly color: Vec3;
  readonly opacity: number;
}

export type LightType = 'headlight' | 'directional' | 'point';
export interface Light {
  readonly type: LightType;
  readonly intensity: number;
  readonly color: Vec3;
  /** Of a directional light: towards which it shines. */
  readonly direction?: Vec3;
  /** Of a point light, in millimetres. */
  readonly position?: Vec3;
}

export interface VolumeLook {
  readonly mode: Mode;
  readonly shading: Shading | null;
  readonly transferFunction: TransferFunction;
  readonly isosurfaces: readonly Isosurface[];
}

export interface Editable {
  readonly volume: VolumeLook;
  readonly lights: readonly Light[];
  readonly background: Vec3;
  readonly step: number;
}

export interface Edit {
  readonly volume?: Partial<VolumeLook>;
  readonly lights?: readonly Light[];
  readonly background?: Vec3;
  readonly step?: number;
}

export const kDefaultShading: Shading = { ambient: 0.2, diffuse: 0.7, specular: 0.2, shininess: 20 };

export const cameraOf: decode.Decoder<Camera> = (value, where) => {
  const at = decode.fields(value, where);
  return {
    position: at('position', decode.vec3),
    target: at('target', decode.vec3),
    up: at('up', decode.vec3),
    fovy: at('fovy', decode.number),
  };
};

const shadingOf: decode.Decoder<Shading> = (value, where) => {
  const at = decode.fields(value, where);
  return {
    ambient: at('ambient', decode.optional(decode.number, kDefaultShading.ambient)),
    diffuse: at('diffuse', decode.optional(decode.number, kDefaultShading.diffuse)),
    specular: at('specular', decode.optional(decode.number, kDefaultShading.specular)),
    shininess: at('shininess', decode.optional(decode.number, kDefaultShading.shininess)),
  };
};

const ascending = <T extends readonly number[]>(nodes: T[], where: string): T[] => {
  if (nodes.length === 0) throw new decode.DecodeError(`${where}: at least one node expected`);
  if (nodes.some((node, i) => i > 0 && node[0]! < nodes[i - 1]![0]!)) {
    throw new decode.DecodeError(`${where}: nodes in ascending order expected`);
  }
  return nodes;
};

const transferFunctionOf: decode.Decoder<TransferFunction> = (value, where) => {
  const at = decode.fields(value, where);
  const color = at('color', decode.list(decode.numbers(4))) as unknown as ColorNode[];
  const opacity = at('opacity', decode.list(decode.numbers(2))) as unknown as OpacityNode[];
  return {
    unitDistance: at('unitDistance', decode.optional(decode.number, 1)),
    color: ascending(color, `${where}.color`),
    opacity: ascending(opacity, `${where}.opacity`),
  };
};

const isosurfaceOf: decode.Decoder<Isosurface> = (value, where) => {
  const at = decode.fields(value, where);
  return {
    value: at('value', decode.number),
    color: at('color', decode.optional(decode.vec3, [0.9, 0.8, 0.7] as Vec3)),
    opacity: at('opacity', decode.optional(decode.number, 1)),
  };
};

const lightOf: decode.Decoder<Light> = (value, where) => {
  const at = decode.fields(value, where);
  const type = at('type', decode.oneOf('headlight', 'directional', 'point'));
  const light = {
    type,
    intensity: at('intensity', decode.optional(decode.number, 1)),
    color: at('color', decode.optional(decode.vec3, [1, 1, 1] as Vec3)),
  };
  if (type === 'directional') return { ...light, direction: at('direction', decode.vec3) };
  if (type === 'point') return { ...light, position: at('position', decode.vec3) };
  return light;
};

export const volumeLookOf: decode.Decoder<VolumeLook> = (value, where) => {
  const at = decode.fields(value, where);
  return {
    mode: at('mode', decode.optional(decode.oneOf('dvr', 'isosurface', 'mip'), 'dvr' as Mode)),
    shading: at('shading', decode.optional<Shading | null>(shadingOf, null)),
    transferFunction: at('transferFunction', transferFunctionOf),
    isosurfaces: at('isosurfaces', decode.optional(decode.list(isosurfaceOf, 64), [] as Isosurface[])),
  };
};

const defaultLights: Light[] = [{ type: 'headlight', intensity: 1, color: [1, 1, 1] }];

/** An `Editable` in the words of `edit`: `volume`, `lights`, `background`, `step`. */
export const editableOf: decode.Decoder<Editable> = (value, where) => {
  const at = decode.fields(value, where);
  return {
    volume: at('volume', volumeLookOf),
    lights: at('lights', decode.optional(decode.list(lightOf, 64), defaultLights)),
    background: at('background', decode.optional(decode.vec3, [0, 0, 0] as Vec3)),
    step: at('step', decode.optional(decode.number, 0)),
  };
};

/** What the page needs of a complete scene file. */
export interface SceneState {
  readonly camera: Camera;
  readonly width: number;
  readonly height: number;
  readonly editable: Editable;
}

export const sceneOf: decode.Decoder<SceneState> = (value, where) => {
  const scene = decode.record(value, where);
  const image = decode.fields(scene.image ?? {}, `${where}.image`);
  const volumes = decode.list(decode.record, 64)(scene.volumes, `${where}.volumes`);
  return {
    camera: cameraOf(scene.camera, `${where}.camera`),
    width: image('width', decode.optional(decode.count, 512)),
    height: image('height', decode.optional(decode.count, 512)),
    editable: editableOf({
      volume: volumes[0], lights: scene.lights, background: image('background', (v) => v), step: scene.step,
    }, where),
  };
};

export function applied(base: Editable, edit: Edit): Editable {
  return { ...base, ...edit, volume: { ...base.volume, ...edit.volume } };
}

/** What must be said to get from `from` to `to`. */
export function difference(from: Editable, to: Editable): Edit {
  const changed = (a: unknown, b: unknown): boolean => JSON.stringify(a) !== JSON.stringify(b);
  const keys = Object.keys(to.volume) as (keyof VolumeLook)[];
  const look = keys.filter((key) => changed(from.volume[key], to.volume[key]))
    .map((key) => [key, to.volume[key]] as const);
  return {
    ...(look.length > 0 && { volume: Object.fromEntries(look) as Partial<VolumeLook> }),
    ...(changed(from.lights, to.lights) && { lights: to.lights }),
    ...(changed(from.background, to.background) && { background: to.background }),
    ...(from.step !== to.step && { step: to.step }),
  };
}

/** One edit that does what `first` and then `second` do. */
export function merged(first: Edit, second: Edit): Edit {
  const volume = first.volume || second.volume ? { volume: { ...first.volume, ...second.volume } } : {};
  return { ...first, ...second, ...volume };
}

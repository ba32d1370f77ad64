// SPDX-License-Identifier: Apache-2.0
// Operations on the nodes of a transfer function. Nodes stay in ascending order of value and there
// is always at least one; two nodes of equal value are a step, and the later one holds at it.

import type { ColorNode, OpacityNode, TransferFunction } from './scene';
import type { Vec3 } from './vector';

type Node = readonly [number, ...number[]];

const clamp = (x: number, low: number, high: number): number => Math.min(Math.max(x, low), high);

/** The node values joined linearly at `value`, constant outside. */
function interpolated(nodes: readonly Node[], value: number): number[] {
  let right = nodes.findIndex((node) => node[0] > value);
  if (right < 0) right = nodes.length;
  const a = nodes[Math.max(right - 1, 0)]!;
  const b = nodes[Math.min(right, nodes.length - 1)]!;
  const t = b[0] > a[0] ? clamp((value - a[0]) / (b[0] - a[0]), 0, 1) : 0;
  return a.slice(1).map((x, i) => x + t * (b[i + 1]! - x));
}

export const opacityAt = (nodes: readonly OpacityNode[], value: number): number => interpolated(nodes, value)[0]!;

export const colorAt = (nodes: readonly ColorNode[], value: number): Vec3 =>
  interpolated(nodes, value) as unknown as Vec3;

/** Where node `index` may go without passing its neighbours, within [low, high]. */
export function room(nodes: readonly Node[], index: number, domain: readonly [number, number]): [number, number] {
  return [nodes[index - 1]?.[0] ?? domain[0], nodes[index + 1]?.[0] ?? domain[1]];
}

export function movedOpacity(nodes: readonly OpacityNode[], index: number, value: number, alpha: number,
  domain: readonly [number, number]): OpacityNode[] {
  const [low, high] = room(nodes, index, domain);
  return nodes.map((node, i) => (i === index ? [clamp(value, low, high), clamp(alpha, 0, 1)] : node));
}

export function movedColor(nodes: readonly ColorNode[], index: number, value: number,
  domain: readonly [number, number]): ColorNode[] {
  const [low, high] = room(nodes, index, domain);
  return nodes.map((node, i) => (i === index ? [clamp(value, low, high), node[1], node[2], node[3]] : node));
}

export function recolored(nodes: readonly ColorNode[], index: number, rgb: Vec3): ColorNode[] {
  return nodes.map((node, i) => (i === index ? [node[0], ...rgb] : node));
}

function inserted<T extends Node>(nodes: readonly T[], node: T): { nodes: T[]; index: number } {
  const after = nodes.findIndex((other) => other[0] > node[0]);
  const index = after < 0 ? nodes.length : after;
  return { nodes: [...nodes.slice(0, index), node, ...nodes.slice(index)], index };
}

export const withOpacity = (nodes: readonly OpacityNode[], value: number, alpha: number) =>
  inserted<OpacityNode>(nodes, [value, clamp(alpha, 0, 1)]);

/** A new node that changes no colour until it is edited. */
export const withColor = (nodes: readonly ColorNode[], value: number) =>
  inserted<ColorNode>(nodes, [value, ...colorAt(nodes, value)]);

/** Without node `index`; the last node stays. */
export const without = <T extends Node>(nodes: readonly T[], index: number): T[] =>
  nodes.length > 1 ? nodes.filter((_, i) => i !== index) : [...nodes];

/** Halfway to the next node (or the previous one for the last): where a key press adds a node. */
export function beside(nodes: readonly Node[], index: number, domain: readonly [number, number]): number {
  const here = nodes[index]?.[0] ?? domain[0];
  const next = nodes[index + 1]?.[0] ?? (here < domain[1] ? domain[1] : (nodes[index - 1]?.[0] ?? domain[0]));
  return (here + next) / 2;
}

/** The values that the editor shows: the data's range and every node. */
export function domainOf(range: readonly [number, number], tf: TransferFunction): [number, number] {
  const values = [...range, ...tf.color.map((node) => node[0]), ...tf.opacity.map((node) => node[0])];
  const [low, high] = [Math.min(...values), Math.max(...values)];
  return high > low ? [low, high] : [low - 0.5, low + 0.5];
}

/** A display colour 0 … 1 as #rrggbb and back. */
export const hexOf = (rgb: Vec3): string =>
  `#${rgb.map((x) => Math.round(clamp(x, 0, 1) * 255).toString(16).padStart(2, '0')).join('')}`;

export function rgbOf(hex: string): Vec3 | null {
  const match = /^#([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})$/i.exec(hex);
  if (!match) return null;
  const [r, g, b] = match.slice(1).map((digits) => Number((parseInt(digits, 16) / 255).toFixed(4)));
  return [r!, g!, b!];
}

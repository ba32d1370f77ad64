// SPDX-License-Identifier: Apache-2.0
// `window.goldthread`: a read-only look at the page for tests and for the curious. The same facts
// stand as data attributes on the canvas: data-picture, data-final ("true", "false"),
// data-epoch, data-viewer and data-serial (the input that the picture answers), data-phase,
// data-connection ("connecting", "loading", "open", "lost", "denied", "failed") and data-drives.

import type { Connection } from './connection';
import type { PictureView } from './picture-view';
import type { Session } from './session';

function stateOf(session: Session, connection: Connection, view: PictureView) {
  const link = session.failed ? 'failed' : connection.current !== 'open' ? connection.current
    : session.connected ? 'open' : 'loading';
  return {
    connection: link,
    viewer: session.viewer,
    driver: session.driver,
    viewers: session.viewers,
    drives: session.drives,
    serial: session.serial,
    unanswered: session.unanswered,
    /** The picture on the canvas: number, epoch, viewer, serial, width, height, final, cine frame, error. */
    picture: view.last,
    /** Of that picture, in 1/255; null: unknown. */
    estimatedError: view.last?.estimatedError ?? null,
    /** What the server does: "moving", "refining", "converged" or "cine"; null before it has told. */
    phase: session.status?.phase ?? null,
    display: session.display,
    /** The frames of the cine loop that the page holds, and whether it plays them. */
    cine: view.cine,
    camera: session.camera,
    editable: session.editable,
    size: session.size,
    status: session.status,
    /** What the server is asked for beside the picture, and what it told of that last. */
    watches: session.watches,
    load: session.load,
    tiles: session.tiles,
    latencyMedian: session.latencies.quantile(0.5),
    latencyP95: session.latencies.quantile(0.95),
    notice: session.notice,
    refusal: session.refusal,
    failed: session.failed,
  };
}

export interface DebugHandle {
  state(): ReturnType<typeof stateOf>;
  /** The canvas's pixels as they are: RGBA rows from the top, alpha 255. */
  pixels(): ImageData;
}

declare global {
  interface Window { goldthread: DebugHandle }
}

export function installDebugHandle(session: Session, connection: Connection, view: PictureView, canvas: HTMLCanvasElement): void {
  const state = (): ReturnType<typeof stateOf> => stateOf(session, connection, view);
  window.goldthread = Object.freeze({ state, pixels: () => view.pixels() });
  const mirror = (): void => {
    const { connection: link, drives, picture, phase } = state();
    canvas.dataset.connection = link;
    canvas.dataset.phase = phase ?? '';
    canvas.dataset.drives = String(drives);
    for (const key of ['picture', 'final', 'epoch', 'viewer', 'serial'] as const) {
      if (picture) canvas.dataset[key] = String(picture[key]);
      else delete canvas.dataset[key];
    }
  };
  session.changed.listen(mirror);
  mirror();
}

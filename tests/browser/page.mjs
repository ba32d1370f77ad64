// SPDX-License-Identifier: Apache-2.0
// A page of a served session in a real browser, seen through window.goldthread. Facts are polled from
// here: the page's content security policy forbids evaluating text in it.

import { existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { setTimeout as pause } from 'node:timers/promises';
import { start, startRanks } from '../cluster/support/program.mjs';

export const chromiumPath = process.env.CHROMIUM ?? '/usr/bin/chromium';
const packages = process.env.GOLDTHREAD_VIEWER_PACKAGES ?? '';
/** Why no page can be opened here; empty if one can. */
export const missing = !existsSync(chromiumPath) ? `there is no ${chromiumPath} (CHROMIUM names another)`
  : !existsSync(path.join(packages, 'playwright-core')) ? 'playwright-core is not installed' : '';

/** A session of `ranks` under mpirun, or of one process, at `url` as soon as it serves. */
export async function serve(scene, options, ranks = 0) {
  const args = ['serve', scene, '--port', '0', ...options];
  const session = ranks > 0 ? startRanks(ranks, args, { seconds: 280 }) : start(args, { seconds: 280 });
  await session.until(() => /http:\S+\n/.test(session.stdout));
  return Object.assign(session, { url: session.stdout.match(/http:\S+/)[0] });
}

export async function openBrowser() {
  const { chromium } = createRequire(path.join(packages, 'x.js'))('playwright-core');
  return chromium.launch({
    executablePath: chromiumPath, handleSIGINT: false, handleSIGTERM: false,
    args: ['--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage'],
  });
}

export class SessionPage {
  /** Opens the address; what the page complains about is collected in `complaints`. */
  static async open(browser, url, viewport = { width: 1000, height: 700 }) {
    const page = await browser.newPage({ viewport });
    page.setDefaultTimeout(60000);
    const self = new SessionPage(page);
    self.opened = performance.now();
    await page.goto(url);
    return self;
  }

  constructor(page) {
    this.page = page;
    this.complaints = [];
    page.on('pageerror', (error) => this.complaints.push(error.message));
    page.on('console', (message) => { if (message.type() === 'error') this.complaints.push(message.text()); });
  }

  state() {
    return this.page.evaluate(() => window.goldthread?.state() ?? null);
  }

  /** The state as soon as `condition` holds of it. */
  async until(what, condition, seconds = 60) {
    const end = performance.now() + 1000 * seconds;
    for (;;) {
      const state = await this.state();
      if (state && condition(state)) return state;
      if (performance.now() > end) throw new Error(`not within ${seconds} s: ${what}; ${JSON.stringify(state)}`);
      await pause(10);
    }
  }

  /** The picture at rest, and the state that belongs to it: it becomes better for ever. */
  async atRest() {
    for (;;) {
      const before = await this.rest();
      const picture = await this.picture();
      const state = await this.state();
      if (state.picture.picture === before.picture.picture) return { state, picture };
    }
  }

  /** At rest: the picture is final and answers every input of this page that was not refused. */
  rest() {
    return this.until('a final picture', ({ connection, picture, unanswered }) =>
      connection === 'open' && picture?.final && unanswered === 0, 120);
  }

  /** Makes the window this large; what it leaves to the picture, as {width, height} in CSS pixels. */
  async resize(width, height) {
    await this.page.setViewportSize({ width, height });
    return this.stage();
  }

  stage() {
    return this.page.evaluate(() => {
      const { clientWidth: width, clientHeight: height } = document.querySelector('main.stage');
      return { width, height };
    });
  }

  /** At rest, with a picture of this size. */
  async restAt({ width, height }) {
    await this.until(`a final picture of ${width} × ${height}`, ({ picture }) =>
      picture?.final && picture.width === width && picture.height === height, 120);
    return this.rest();
  }

  /** The canvas as {width, height, rgb}. */
  async picture() {
    const { width, height, base64 } = await this.page.evaluate(() => {
      const { width: w, height: h, data } = window.goldthread.pixels();
      let text = '';
      for (let i = 0; i < data.length; i += 4) text += String.fromCharCode(data[i], data[i + 1], data[i + 2]);
      return { width: w, height: h, base64: btoa(text) };
    });
    return { width, height, rgb: Buffer.from(base64, 'base64') };
  }

  /** A drag across the canvas in `steps`, by (x, y) CSS pixels each; `watch` is called at every step. */
  async drag(steps, x, y, watch = async () => {}) {
    const box = await this.page.locator('canvas').first().boundingBox();
    const from = { x: box.x + box.width / 2, y: box.y + box.height / 2 };
    await this.page.mouse.move(from.x, from.y);
    await this.page.mouse.down();
    for (let i = 1; i <= steps; ++i) {
      await this.page.mouse.move(from.x + x * i, from.y + y * i);
      await watch(i);
    }
    await this.page.mouse.up();
  }
}

/** What a page shows, as a scene file of the same volume. */
export function sceneOfState({ camera, editable, size }, file) {
  const { shading, ...volume } = editable.volume;
  return {
    goldthread: 1,
    image: { width: size.width, height: size.height, background: editable.background },
    camera, lights: editable.lights,
    volumes: [{ file, ...volume, ...(shading ? { shading } : {}) }],
  };
}

/** The hash of a link that carries this look (viewer/src/link.ts). */
export const linkOf = (look) => `#look=${Buffer.from(JSON.stringify({ v: 1, ...look })).toString('base64url')}`;

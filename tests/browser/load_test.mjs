// SPDX-License-Identifier: Apache-2.0
// The load of a served session, as the page shows it: bars, time lines, bytes, and tiles over the
// picture. Ends with 77 where there is no browser or no head to show.

import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import test, { after, before } from 'node:test';
import { setTimeout as pause } from 'node:timers/promises';
import { headScene, headVolume } from '../cluster/support/program.mjs';
import { missing, openBrowser, serve, SessionPage } from './page.mjs';

const absent = missing || (existsSync(headVolume) ? '' : 'the head of Debian\'s mricron-data is not installed');
if (absent) {
  console.log(`skipped: ${absent}`);
  process.exit(77);
}

const kWorkers = [2, 3, 4];
const kTiles = 16;  // 250 × 230 in tiles of 64
let browser, session, page;
before(async () => {
  browser = await openBrowser();
  session = await serve(headScene, ['--size', '250x230', '--workers', '3', '--threads', '1']);
  page = await SessionPage.open(browser, session.url);
  await page.until('a picture', ({ picture }) => picture !== null);
});
after(async () => {
  await browser?.close();
  session?.signal('SIGTERM');
  await session?.ended;
});

/** What the page has at an element, by its selector. */
const count = (selector) => page.page.locator(selector).count();
/** How many pixels of a canvas are not transparent, and its place in the window. */
const inked = (selector) => page.page.evaluate((wanted) => {
  const canvas = document.querySelector(wanted);
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let ink = 0;
  for (let i = 3; i < data.length; i += 4) ink += data[i] > 0 ? 1 : 0;
  const { x, y, width, height } = canvas.getBoundingClientRect();
  return { share: (4 * ink) / data.length, box: { x, y, width, height } };
}, selector);

test('A page that does not look is told nothing', async () => {
  await pause(1000);
  const { watches, load, tiles } = await page.state();
  assert.deepEqual({ watches, load, tiles }, { watches: { load: false, tiles: false }, load: null, tiles: null });
  assert.equal(await count('canvas'), 1, 'nothing is drawn but the picture');
});

test('The panel shows each rank\'s work, when it worked, and the bytes', async () => {
  await page.page.keyboard.press('l');
  const { load } = await page.until('a load with work', (state) => state.load?.ranks.some(({ rank, busy }) => rank >= 2 && busy > 0));
  assert.deepEqual(load.ranks.map(({ rank }) => rank), [0, 1, ...kWorkers]);
  assert.deepEqual(load.ranks.map(({ role }) => role), ['master', 'compositor', 'worker', 'worker', 'worker']);
  for (const { share, busy, error, view, role } of load.ranks) {
    assert.equal(share.length, 128);
    assert.equal(view !== null, role === 'worker');
    // A second of bins, rounded to 64 steps each.
    const second = share.slice(-20).reduce((sum, part) => sum + part, 0) / 20;
    assert.ok(Math.abs(second - busy) < 0.01, `${second} ${busy}`);
    assert.ok(error < 1000, `${error} ms`);
  }
  assert.ok(load.bytes.some(({ kind, total }) => kind === 'Samples' && total > 1000));

  assert.equal(await count('.load-bar'), 5);
  const widths = await page.page.locator('.load-bar .fill').evaluateAll((fills) => fills.map(({ style }) => parseFloat(style.width)));
  assert.equal(Math.max(...widths), 100, 'normalised to the highest');
  await page.page.locator('.imbalance').getByText(/imbalance/).waitFor();
  await page.page.locator('.traffic').getByText('Samples').waitFor();
  await page.page.getByText(/clocks agree within \d/).waitFor();
  const lanes = await inked('.timeline canvas');
  assert.ok(lanes.share > 0.5 && lanes.box.height > 5 * 9, JSON.stringify(lanes));
});

test('A view that has been cast is told of in all', async () => {
  await page.page.locator('label:has(input[value="view"])').click();
  await page.page.locator('.load-bar .value').filter({ hasText: /(µs|ms|s)$/ }).first().waitFor();
  assert.equal(await count('.load-bar'), kWorkers.length, 'the others cast nothing');
  await page.page.locator('label:has(input[value="second"])').click();
});

test('Tiles lie over the picture and cover it once', async () => {
  await page.page.locator('canvas').first().focus();
  await page.page.keyboard.press('o');
  const { tiles } = await page.until('tiles', (state) => state.tiles !== null);
  assert.equal(tiles.tiles.length, kTiles);
  assert.equal(tiles.tiles.reduce((sum, { width, height }) => sum + width * height, 0), 250 * 230);
  for (const { rank, cost } of tiles.tiles) assert.ok(kWorkers.includes(rank) && cost > 0, `${rank}: ${cost} ms`);
  await page.page.getByText('Cast by rank').waitFor();
  assert.equal(await count('.tile-legend .chip'), new Set(tiles.tiles.map(({ rank }) => rank)).size);
  const { share, box } = await inked('canvas.tiles');
  assert.equal(share, 1);
  assert.deepEqual(box, await page.page.locator('canvas').first().boundingBox());

  await page.page.keyboard.press('t');
  await page.page.getByText('Time spent').waitFor();
  await page.page.getByText('per 64 × 64 pixels').waitFor();
});

test('The picture under the tiles can be turned, and the tiles follow', async () => {
  const before = await page.state();
  await page.drag(8, 8, 3);
  const { camera } = await page.until('tiles of a newer view', ({ tiles }) => tiles?.epoch > before.tiles.epoch);
  assert.notDeepEqual(camera.position, before.camera.position);
});

test('What is taken away is asked for no more', async () => {
  await page.page.keyboard.press('t');
  await page.until('no tiles', ({ watches, tiles }) => !watches.tiles && tiles === null);
  assert.equal(await count('canvas.tiles'), 0);
  assert.ok(await page.page.locator('.tile-legend').isHidden());
  await page.page.keyboard.press('p');
  await page.until('a folded panel watches nothing', ({ watches }) => !watches.load);
  await page.page.keyboard.press('p');
  await page.until('it watches again', ({ watches, load }) => watches.load && load !== null);
  await page.page.keyboard.press('l');
  await page.until('a closed one watches nothing', ({ watches, load }) => !watches.load && load === null);
});

test('Pages that watch and pages that do not live side by side', async () => {
  const second = await SessionPage.open(browser, session.url);
  await second.until('it watches the session', ({ connection, drives }) => connection === 'open' && !drives);
  await second.page.keyboard.press('l');
  await second.until('its load', ({ load }) => load !== null);
  assert.equal((await page.state()).load, null);
  assert.deepEqual(second.complaints, []);
  await second.page.close();
});

test('Nothing was complained about', () => assert.deepEqual(page.complaints, []));

// SPDX-License-Identifier: Apache-2.0
// What watching the load costs: pictures a second of a drag with the page's load panel and its overlays, and without, in
// turns. By hand, on a machine that is left alone:
//
//   GOLDTHREAD_VIEWER_PACKAGES=build/release/viewer/stage/viewer/node_modules node bench/page/watched_drag.mjs

import { headScene } from '../../tests/cluster/support/program.mjs';
import { missing, openBrowser, serve, SessionPage } from '../../tests/browser/page.mjs';

if (missing) {
  console.log(`cannot measure: ${missing}`);
  process.exit(77);
}

const kRounds = 7, kSteps = 240;
const kWays = { 'not watched': [], 'load panel': ['l'], 'panel and both overlays': ['l', 'o', 't'] };

const middle = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];

/** Pictures that the session made a second while the camera was dragged to and fro. */
async function dragged(page) {
  const before = (await page.state()).picture.picture, begin = performance.now();
  await page.drag(kSteps / 2, 1, 0);
  await page.drag(kSteps / 2, -1, 0);
  const { picture } = await page.state();
  return (1000 * (picture.picture - before)) / (performance.now() - begin);
}

const browser = await openBrowser();
const session = await serve(headScene, ['--size', '512x512']);
try {
  const page = await SessionPage.open(browser, session.url);
  await page.rest();
  await dragged(page);  // the first knows nothing of costs
  const rates = Object.fromEntries(Object.keys(kWays).map((way) => [way, []]));
  for (let round = 0; round < kRounds; ++round)
    for (const [way, keys] of Object.entries(kWays)) {
      for (const key of keys) await page.page.keyboard.press(key);
      await page.rest();
      rates[way].push(await dragged(page));
      for (const key of keys) await page.page.keyboard.press(key);
    }
  const plain = middle(rates['not watched']);
  for (const [way, all] of Object.entries(rates))
    console.log(`${way}: ${middle(all).toFixed(1)} pictures/s (${Math.min(...all).toFixed(1)} … ${Math.max(...all).toFixed(1)}), ` +
                `${(middle(all) / plain).toFixed(3)} of what it is unwatched`);
} finally {
  await browser.close();
  session.signal('SIGTERM');
  await session.ended;
}

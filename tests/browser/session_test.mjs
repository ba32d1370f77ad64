// SPDX-License-Identifier: Apache-2.0
// A session as its user sees it: `goldthread serve`, and the page in a real browser. At rest the page
// shows the picture that `goldthread render` makes of the page's own camera and scene, to the bit.
// Argument: "process" or "mpi". Ends with 77 where there is no browser or no head to show.

import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import test, { after, before } from 'node:test';
import { headScene, headVolume, inScratch, run, start } from '../cluster/support/program.mjs';
import { writeJson } from '../cluster/support/data.mjs';
import { covered, difference, readPng } from '../cluster/support/picture.mjs';
import { linkOf, missing, openBrowser, serve, SessionPage, sceneOfState } from './page.mjs';

const absent = missing || (existsSync(headVolume) ? '' : 'the head of Debian\'s mricron-data is not installed');
if (absent) {
  console.log(`skipped: ${absent}`);
  process.exit(77);
}

const mpi = process.argv[2] === 'mpi';
const kSize = '256x256';
// Else it would depend on the error that is asked for.
const kStep = ['--step', '0.5'];

const served = (scene, options = []) => serve(scene, [...kStep, ...options], mpi ? 3 : 0);

let offlineCount = 0;
/** What `goldthread render` makes of what the page says it shows, refined as far. */
async function offline(state) {
  const name = `offline-${++offlineCount}`;
  const scene = writeJson(`${name}.json`, sceneOfState(state, headVolume));
  const made = await run(['render', scene, '-o', inScratch(`${name}.png`), ...kStep,
    '--size', `${state.size.width}x${state.size.height}`, '--error', String(1.000001 * state.picture.estimatedError)]);
  assert.equal(made.status, 0, made.stderr);
  return readPng(inScratch(`${name}.png`));
}

async function expectOffline(page) {
  const { state, picture } = await page.atRest();
  assert.deepEqual(difference(picture, await offline(state)), { pixels: 0, greatest: 0, mean: 0 });
  return state;
}

let browser, session, page;
before(async () => {
  browser = await openBrowser();
  session = await served(headScene, ['--size', kSize]);
  page = await SessionPage.open(browser, session.url);
});
after(async () => {
  await browser?.close();
  session?.signal('SIGTERM');
  await session?.ended;
});

test('The page shows the head of the scene file', async () => {
  await page.rest();
  const picture = await page.picture();
  assert.equal(`${picture.width}x${picture.height}`, kSize);
  assert.ok(covered(picture) > 0.2, `${covered(picture)}`);
  await expectOffline(page);
});

test('A drag turns the head', async () => {
  const before = await page.state();
  const old = await page.picture();
  await page.drag(12, 8, 3);
  const state = await expectOffline(page);
  assert.notDeepEqual(state.camera.position, before.camera.position);
  assert.deepEqual(state.camera.target, before.camera.target);
  assert.ok(difference(await page.picture(), old).mean > 1);
});

test('A mode is chosen', async () => {
  const before = await page.picture();
  await page.page.locator('label:has(input[value="mip"])').click();
  await page.until('mip', ({ editable }) => editable.volume.mode === 'mip');
  await expectOffline(page);
  assert.ok(difference(await page.picture(), before).mean > 1);
  await page.page.locator('label:has(input[value="dvr"])').click();
  await expectOffline(page);
});

if (!mpi) {
  test('A node of the transfer function is moved by keys and by numbers', async () => {
    const before = await page.rest();
    const picture = await page.picture();
    const node = page.page.locator('svg.opacity-plot [aria-label]').nth(3);
    await node.focus();
    for (let i = 0; i < 5; ++i) await page.page.keyboard.press('ArrowUp');
    const byKeys = await expectOffline(page);
    assert.notDeepEqual(byKeys.editable.volume.transferFunction.opacity, before.editable.volume.transferFunction.opacity);
    const field = page.page.getByLabel('Opacity of the selected node');
    await field.fill('0.6');
    await field.press('Enter');
    const byNumber = await expectOffline(page);
    assert.ok(byNumber.editable.volume.transferFunction.opacity.some(([, alpha]) => alpha === 0.6));
    assert.ok(difference(await page.picture(), picture).mean > 0.1);
  });

  test('How good the picture is stands at the picture', async () => {
    const { estimatedError } = await page.rest();
    assert.ok(estimatedError >= 0, `${estimatedError}`);
    await page.until('a status of the picture at rest', ({ phase }) => phase === 'converged');
    await page.page.getByText(/^± \S+ \/ 255 · \S+ samples per pixel · converged$/).waitFor();
  });

  test('It rocks at rest on wish, until something is done', async () => {
    await page.rest();
    await page.page.locator('canvas').focus();  // in a field of the panel a key would be text
    await page.page.keyboard.press('c');
    const { cine, display } = await page.until('the loop plays', (state) => state.cine.playing, 120);
    assert.equal(cine.frames, 7);
    assert.equal(display.cine, true);
    await page.page.getByText(/ · rocking$/).waitFor();
    await page.drag(3, 10, 0);
    await page.until('a picture ended the loop', (state) => !state.cine.playing && state.cine.frames < 7);
    await page.until('it rocks again', (state) => state.cine.playing, 120);
    await page.page.keyboard.press('c');
    await page.until('it stands still', (state) => !state.display.cine && state.cine.frames === 0);
    await expectOffline(page);
  });

  test('A second page watches, and takes over', async () => {
    const second = await SessionPage.open(browser, session.url);
    const watching = await second.rest();
    assert.equal(watching.drives, false);
    assert.equal(watching.viewers, 2);
    await expectOffline(second);
    await page.drag(3, 10, 0);
    const turned = await page.rest();
    await second.until('the driver\'s camera', ({ camera, picture }) =>
      picture?.final && camera.position[0] === turned.camera.position[0]);
    await expectOffline(second);

    await second.page.getByRole('button', { name: 'Take over' }).click();
    await second.until('it drives', ({ drives }) => drives);
    await page.until('it watches', ({ drives }) => !drives);
    await second.drag(3, 0, 10);
    await expectOffline(second);
    await page.page.getByRole('button', { name: 'Take over' }).click();
    await page.until('it drives again', ({ drives }) => drives);
    assert.deepEqual(second.complaints, []);
    await second.page.close();
  });

  test('What the server refuses is told in its own words', async () => {
    const { lights } = (await page.rest()).editable;
    const bad = { lights: [...lights, { type: 'directional', intensity: 1, color: [1, 1, 1], direction: [0, 0, 0] }] };
    const { camera, editable } = await page.state();
    const look = { camera, editable: { ...editable, ...bad } };
    const refused = page.until('a refusal', ({ refusal }) => refusal !== null);
    await page.page.evaluate((text) => { location.hash = text; }, linkOf(look));
    const { refusal } = await refused;
    assert.match(`${refusal.where}: ${refusal.what}`, /direction/);
    assert.ok(await page.page.getByText(refusal.what).first().isVisible());
    assert.deepEqual((await page.rest()).editable.lights, lights);
  });

  test('An image size that the user of the server fixed stays, and the page is told', async () => {
    await page.page.locator('summary', { hasText: 'Image' }).click();
    const choice = page.page.locator('label:has(> span:text-is("Size")) select');
    await choice.selectOption('512');
    const { refusal } = await page.until('a refusal', (state) => state.refusal?.where === 'size');
    assert.match(refusal.what, /fixed/);
    const state = await page.rest();
    assert.equal(`${state.size.width}x${state.size.height}`, kSize);
    assert.equal(await choice.inputValue(), 'keep');
  });
}

test('The picture of a scene without a size follows the window', async () => {
  const open = await served(headVolume);
  const window = await SessionPage.open(browser, open.url, { width: 400, height: 400 });
  await window.restAt(await window.stage());
  for (const [width, height] of [[480, 360], [300, 420]]) {
    const stage = await window.resize(width, height);
    assert.equal(stage.width, width);
    await window.restAt(stage);
    await expectOffline(window);
  }

  if (!mpi) {
    // Back to the old size before the server has said anything about the new one.
    const before = await window.state();
    open.signal('SIGSTOP');
    await window.resize(320, 440);
    await window.until('the new size is asked for', ({ serial }) => serial === before.serial + 1, 20);
    const stage = await window.resize(300, 420);
    await window.until('the old size is asked for', ({ serial }) => serial === before.serial + 2, 20);
    open.signal('SIGCONT');
    await window.until('an answer', ({ unanswered }) => unanswered === 0);
    await window.restAt(stage);
  }
  assert.deepEqual(window.complaints, []);
  await window.page.close();
  open.signal('SIGTERM');
  await open.ended;
});

test('Nothing was complained about', () => assert.deepEqual(page.complaints, []));

if (!mpi) {
  test('A server that dies is told, and found again', async () => {
    const { port, searchParams } = new URL(session.url);
    session.signal('SIGKILL');
    await session.ended;
    await page.until('the loss', ({ connection }) => connection === 'lost');
    assert.ok(await page.page.getByText('Connection lost').isVisible());
    session = start(['serve', headScene, ...kStep, '--size', kSize, '--port', port, '--token', searchParams.get('token')],
                    { seconds: 200 });
    await page.until('the connection', ({ connection }) => connection === 'open');
    await expectOffline(page);
  });
}

// SPDX-License-Identifier: Apache-2.0
// Screenshots of the page against the mock: node mock/shots.mjs DIRECTORY (the development server
// must be running). CHROMIUM names the browser, /usr/bin/chromium by default.

import { mkdirSync } from 'node:fs';
import { chromium } from 'playwright-core';

const directory = process.argv[2] ?? 'shots';
const address = process.argv[3] ?? 'http://127.0.0.1:5173/?token=mock';
mkdirSync(directory, { recursive: true });
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--disable-gpu', '--disable-background-networking', '--no-first-run'],
});

async function shoot(name, options, prepare = async () => {}) {
  const page = await browser.newPage(options);
  page.on('console', (message) => { if (message.type() === 'error') console.log(`${name}: ${message.text()}`); });
  page.on('pageerror', (error) => console.log(`${name}: ${error.message}`));
  await page.goto(address);
  await page.waitForFunction(() => document.querySelector('canvas')?.dataset.final === 'true', null, { timeout: 60000 });
  await prepare(page);
  await page.screenshot({ path: `${directory}/${name}.png` });
  await page.close();
}

const open = (title) => async (page) => {
  await page.evaluate((wanted) => {
    for (const section of document.querySelectorAll('details')) {
      section.open = section.querySelector('h2').textContent === wanted || wanted === 'all';
    }
  }, title);
  await page.waitForTimeout(600);
};

const desktop = { width: 1280, height: 800 };
await shoot('dark', { viewport: desktop, colorScheme: 'dark' });
await shoot('light', { viewport: desktop, colorScheme: 'light' });
await shoot('status', { viewport: desktop, colorScheme: 'dark' }, async (page) => {
  await page.mouse.move(400, 400);
  await page.mouse.down();
  for (let i = 0; i < 30; ++i) await page.mouse.move(400 + 6 * i, 400 + 2 * i);
  await page.mouse.up();
  await page.waitForTimeout(2500);
  await open('all')(page);
  await page.evaluate(() => { document.querySelector('.scroll').scrollTop = 1e6; });
});
await shoot('moving', { viewport: desktop, colorScheme: 'dark' }, async (page) => {
  await page.mouse.move(400, 400);
  await page.mouse.down();
  for (let i = 0; i < 10; ++i) await page.mouse.move(400 - 6 * i, 400);
  await open('Image')(page);
});
await shoot('rocking', { viewport: desktop, colorScheme: 'light' }, async (page) => {
  await page.keyboard.press('c');
  await page.waitForFunction(() => globalThis.goldthread.state().cine.playing, null, { timeout: 90000 });
  await open('Image')(page);
});
for (const [name, key] of [['owners', 'o'], ['cost', 't']]) {
  await shoot(`load-${name}`, { viewport: desktop, colorScheme: name === 'cost' ? 'light' : 'dark' }, async (page) => {
    await page.keyboard.press('l');
    await page.keyboard.press(key);
    await page.waitForFunction(() => document.querySelector('canvas.tiles') && document.querySelector('.timeline canvas'));
    await page.waitForTimeout(600);
  });
}
await shoot('lists', { viewport: { width: 1280, height: 1500 }, colorScheme: 'light' }, open('all'));
await shoot('help', { viewport: desktop, colorScheme: 'dark' }, (page) => page.keyboard.press('?'));
await shoot('phone', { viewport: { width: 390, height: 844 }, colorScheme: 'dark', hasTouch: true });
await browser.close();

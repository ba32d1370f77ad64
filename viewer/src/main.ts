// SPDX-License-Identifier: Apache-2.0
// Puts the page together.

import './style.css';
import { Connection } from './connection';
import { button } from './controls';
import { installDebugHandle } from './debug-handle';
import { el } from './dom';
import { helpDialog } from './help';
import { Interactor } from './interactor';
import { lookOf } from './link';
import { loadPanel } from './load/panel';
import { TileOverlay } from './load/tile-overlay';
import { overlay } from './overlay';
import { appearancePanel } from './panels/appearance';
import { imagePanel } from './panels/image';
import { isosurfacePanel, lightPanel } from './panels/scene-lists';
import { statusPanel } from './panels/status';
import { viewPanel } from './panels/view';
import { PictureView } from './picture-view';
import { showRefusals } from './refusals';
import { Session } from './session';
import { saveScreenshot, sharePanel } from './share';
import { keepLaidOut } from './stage';
import { installShortcuts } from './shortcuts';
import { themeButton } from './theme';

function sessionAddress(): string {
  const url = new URL('session', document.baseURI);
  url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
  const token = new URL(location.href).searchParams.get('token');
  if (token !== null) url.searchParams.set('token', token);
  return url.href;
}

const connection = new Connection(sessionAddress);
const session = new Session(connection);
const canvas = el('canvas', {
  class: 'blank',
  width: 512, height: 512, tabIndex: 0, role: 'application',
  aria: { label: 'The rendered picture. Arrow keys turn it, plus and minus zoom, question mark shows help.' },
});
const stage = el('main', { class: 'stage' }, canvas);
const view = new PictureView(canvas, () => session.rocks);
const tiles = new TileOverlay(session, canvas);
const place = keepLaidOut(canvas, stage, () => tiles.schedule());
const load = loadPanel(session, tiles);
const help = helpDialog();

function useToken(token: string): void {
  const url = new URL(location.href);
  url.searchParams.set('token', token);
  history.replaceState(null, '', url);
  connection.retry();
}

/** A link's look is applied once, when this page drives. */
function applyLink(): void {
  const look = lookOf(location.hash);
  if (!look || !session.connected) return;
  if (look.ok && !session.drives) return session.say('Take over to see what the link shows: another page drives.');
  history.replaceState(null, '', location.pathname + location.search);
  if (look.ok) session.applyLook(look.value);
  else session.say(`The link was not used: ${look.problem}.`);
}

function panel(): HTMLElement {
  const badge = el('span', { class: 'badge', role: 'status' });
  const takeOver = button('Take over', 'Drive this session from this page', () => session.takeOver(), 'primary');
  const editing = el('fieldset', { class: 'plain editing' }, ...appearancePanel(session), isosurfacePanel(session),
    lightPanel(session), viewPanel(session), imagePanel(session, stage));
  editing.setAttribute('aria-label', 'What is shown and how');
  const title = el('p', { class: 'volume-name' });
  session.changed.listen((topic) => {
    if (topic !== 'driver' && topic !== 'connection') return;
    const { connected, drives, viewers, volume, loading } = session;
    badge.textContent = loading ? 'Loading' : !connected ? 'Not connected' : drives ? 'You drive' : 'Watching';
    badge.dataset.state = loading ? 'loading' : !connected ? 'off' : drives ? 'driving' : 'watching';
    badge.title = connected ? `${viewers} ${viewers === 1 ? 'page' : 'pages'} on this session` : '';
    takeOver.hidden = !connected || drives;
    editing.disabled = !drives;
    title.textContent = volume ? `${volume.name} · ${volume.size.join(' × ')}` : '';
    document.title = volume ? `${volume.name} – Goldthread` : 'Goldthread';
    document.documentElement.dataset.connected = String(connected);
  });
  const head = el('header', {}, el('h1', {}, 'Goldthread'), title, el('div', { class: 'session' }, badge, takeOver,
    el('span', { class: 'grow' }), themeButton(), button('Help', 'Gestures and keys (?)', () => help.showModal(), 'quiet')));
  return el('aside', { class: 'panel', id: 'panel', aria: { label: 'Controls' } }, head,
    el('div', { class: 'scroll' }, editing, sharePanel(session, canvas), ...statusPanel(session), load));
}

/** Opens the load panel where it can be seen, or closes it. */
function toggleLoad(): void {
  const folded = document.body.classList.contains('folded');
  if (folded) fold.click();
  load.open = folded || !load.open;
  if (load.open) load.scrollIntoView();
}

const side = panel();
const fold = button('Panel', 'Fold or unfold the panel (p)', () => {
  const folded = document.body.classList.toggle('folded');
  fold.setAttribute('aria-expanded', String(!folded));
}, 'fold');
fold.setAttribute('aria-expanded', 'true');
fold.setAttribute('aria-controls', 'panel');
const over = overlay(session, connection, useToken);
stage.append(over.line, over.element, tiles.legend, fold);
document.body.append(stage, side, help);
showRefusals(session, side);

new Interactor(canvas, {
  camera: () => (session.drives ? session.camera : null),
  move: (camera, time) => session.moveCamera(camera, time),
  reference: () => session.volume?.radius ?? 0,
});
installShortcuts(session, {
  help: () => (help.open ? help.close() : help.showModal()),
  fold: () => fold.click(),
  screenshot: () => saveScreenshot(session, canvas),
  overlay: (mode) => tiles.toggle(mode),
  load: toggleLoad,
});
installDebugHandle(session, connection, view, canvas);

connection.region.listen((region) => { if (session.connected) view.push(region); });
connection.problem.listen((problem) => session.say(`The server sent something that makes no sense: ${problem}.`));
connection.state.listen((state) => { if (state === 'open') view.reset(); });
view.problem.listen((problem) => session.say(`A picture could not be shown: ${problem}.`));
view.dropped.listen((picture) => connection.send({ type: 'ack', picture }));
view.shown.listen((picture) => {
  canvas.classList.remove('blank');
  place();
  session.pictureShown(picture);
});
session.changed.listen((topic) => { if (topic === 'driver') applyLink(); });
window.addEventListener('hashchange', applyLink);
document.addEventListener('visibilitychange', () => session.hide(document.visibilityState !== 'visible'));
connection.retry();

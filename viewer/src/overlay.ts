// SPDX-License-Identifier: Apache-2.0
// What lies over the picture: the connection's state in words, loading, failures, notices, the
// golden line of convergence, how good the picture is, and one line of numbers.

import { button } from './controls';
import type { Connection } from './connection';
import { el, shown } from './dom';
import { qualityLine, stateOf } from './quality';
import type { Session } from './session';

const kNoticeMs = 6000;

export interface Overlay {
  readonly element: HTMLElement;
  readonly line: HTMLElement;
}

export function overlay(session: Session, connection: Connection, useToken: (token: string) => void): Overlay {
  const message = messageBox(session, connection, useToken);
  const quality = el('p', { class: 'quality', title: 'Estimated error of this picture (root mean square, of 255 levels), and what happens to it' });
  const numbers = el('p', { class: 'numbers' });
  const notice = el('p', { class: 'notice', role: 'status', hidden: true });
  const thread = el('div', { class: 'thread', role: 'progressbar', aria: { label: 'Convergence', valuemin: '0', valuemax: '100' } }, el('span'));
  let timer = 0;
  const update = (): void => {
    const { connected, picture, status, unanswered } = session;
    quality.textContent = connected ? qualityLine(picture, status, unanswered) : '';
    quality.dataset.state = stateOf(picture, status, unanswered) ?? '';
    numbers.textContent = numbersOf(session);
    const converged = session.picture?.final ? 1 : Math.min(Math.max(session.status?.converged ?? 0, 0), 1);
    (thread.firstElementChild as HTMLElement).style.width = `${converged * 100}%`;
    thread.setAttribute('aria-valuenow', String(Math.round(converged * 100)));
    thread.classList.toggle('done', session.picture?.final ?? false);
  };
  session.changed.listen((topic) => {
    if (topic === 'status' || topic === 'picture' || topic === 'camera' || topic === 'connection') update();
    if (topic !== 'notice') return;
    notice.textContent = session.notice;
    notice.hidden = session.notice === '';
    window.clearTimeout(timer);
    timer = window.setTimeout(() => { notice.hidden = true; }, kNoticeMs);
  });
  return { element: el('div', { class: 'overlay' }, message, notice,
    el('div', { class: 'picture-facts' }, quality, numbers)), line: thread };
}

function numbersOf(session: Session): string {
  const { picture, latencies, status } = session;
  if (!session.connected || !picture) return '';
  const median = latencies.quantile(0.5);
  const rate = session.rate.perSecond(performance.now());
  const lost = status?.ranks.filter(({ state }) => state === 'lost').length ?? 0;
  return [
    `${picture.width} × ${picture.height}`,
    rate > 0 ? `${shown(rate, 2)} per s` : null,
    median === null ? null : `${median.toFixed(0)} ms`,
    lost > 0 ? `${lost} ${lost === 1 ? 'rank' : 'ranks'} lost` : null,
  ].filter((part) => part !== null).join('  ·  ');
}

function messageBox(session: Session, connection: Connection, useToken: (token: string) => void): HTMLElement {
  const title = el('h2', { role: 'alert' });
  const detail = el('p');
  const progress = el('progress', { max: 1 });
  const again = button('Connect now', 'Try to connect again now', () => connection.retry());
  const token = el('input', { type: 'password', name: 'token', autocomplete: 'off', aria: { label: 'Access token' }, placeholder: 'Access token' });
  const form = el('form', { class: 'token' }, token, el('button', { type: 'submit' }, 'Connect'));
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    if (token.value.trim()) useToken(token.value.trim());
    else connection.retry();
  });
  const box = el('div', { class: 'message' }, title, detail, progress, again, form);
  const update = (): void => {
    const state = describe(session, connection);
    box.hidden = state === null;
    if (!state) return;
    if (title.textContent !== state.title) title.textContent = state.title;
    if (detail.textContent !== state.detail) detail.textContent = state.detail;
    box.classList.toggle('bad', state.bad ?? false);
    progress.hidden = state.progress === undefined;
    if (state.progress === null) progress.removeAttribute('value');
    else if (state.progress !== undefined) progress.value = state.progress;
    again.hidden = connection.current !== 'lost';
    form.hidden = connection.current !== 'denied';
  };
  session.changed.listen((topic) => { if (topic === 'connection') update(); });
  window.setInterval(() => { if (connection.current === 'lost') update(); }, 500);
  update();
  return box;
}

interface Description { title: string; detail: string; progress?: number | null; bad?: boolean }

function describe(session: Session, connection: Connection): Description | null {
  const { failed, loading } = session;
  if (failed) {
    const place = failed.where ? `${failed.where}: ` : '';
    return { title: 'The session cannot go on', detail: `${place}${failed.what}${failed.mend ? ` (${failed.mend})` : ''}`, bad: true };
  }
  if (connection.current === 'denied') {
    return { title: 'Not admitted', detail: `${connection.reason}.`, bad: true };
  }
  if (connection.current === 'lost') {
    const seconds = Math.max(0, Math.ceil((connection.nextAttempt - performance.now()) / 1000));
    const why = connection.reason ? `${connection.reason}. ` : '';
    const next = seconds > 0 ? `Trying again in ${seconds} s.` : 'Trying again …';
    return { title: 'Connection lost', detail: `${why}${session.picture ? 'The picture is the last one. ' : ''}${next}`, bad: true };
  }
  if (loading) {
    const known = loading.total > 0;
    const megabytes = (bytes: number): string => (bytes / 1e6).toFixed(0);
    const done = known && loading.total > 1e5 ? `${megabytes(loading.done)} of ${megabytes(loading.total)} MB` : '';
    return { title: `Loading ${loading.what}`, detail: done, progress: known ? Math.min(loading.done / loading.total, 1) : null };
  }
  if (!session.connected) return { title: 'Connecting', detail: '', progress: null };
  return null;
}

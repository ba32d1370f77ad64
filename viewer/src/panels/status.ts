// SPDX-License-Identifier: Apache-2.0
// How it goes: how good the picture is, pictures per second, latency, and what each rank is doing.

import { section } from '../controls';
import { el, shown } from '../dom';
import type { RankStatus, Status } from '../protocol';
import { errorCurve, figure } from '../quality';
import type { Session } from '../session';
import { latencyCurve, sparkline } from './sparkline';

const kFacts = ['Estimated error', 'Samples per pixel', 'Step', 'Spatial error', 'Temporal error', 'Converged', 'Pictures',
  'Latency', 'Rays', 'Epoch', 'Features', 'Kernel', 'Volume', 'Server'] as const;
type Fact = (typeof kFacts)[number];

const inPixels = (error: number | null): string => (error === null ? '–' : `${figure(error)} px`);

function factsOf(status: Status): [Fact, string][] {
  const { estimatedError, target } = status;
  return [
    ['Estimated error', `${estimatedError === null ? '–' : `${figure(estimatedError)} / 255`}, target ${figure(target)}`],
    ['Samples per pixel', figure(status.samplesPerPixel)],
    ['Step', String(status.step)],
    ['Spatial error', inPixels(status.spatialError)],
    ['Temporal error', inPixels(status.temporalError)],
    ['Converged', `${(Math.min(Math.max(status.converged, 0), 1) * 100).toFixed(0)} %`],
    ['Rays', `${Math.round(status.rays).toLocaleString('en')} in ${shown(status.seconds, 3)} s`],
    ['Epoch', String(status.epoch)],
    ['Features', status.features.join(', ') || 'none'],
    ['Kernel', status.kernel || '–'],
  ];
}

export function statusPanel(session: Session): HTMLElement[] {
  const cells = new Map(kFacts.map((name) => [name, el('dd', {}, '–')]));
  const facts = el('dl', { class: 'facts' }, ...[...cells].flatMap(([name, cell]) => [el('dt', {}, name), cell]));
  const errors = sparkline();
  const latency = sparkline();
  const ranks = rankTable();
  const write = (name: Fact, value: string): void => {
    const cell = cells.get(name)!;
    if (cell.textContent !== value) cell.textContent = value;
  };
  const update = (): void => {
    const { status, volume, latencies } = session;
    const [median, p95] = [latencies.quantile(0.5), latencies.quantile(0.95)];
    write('Pictures', `${shown(session.rate.perSecond(performance.now()), 3)} per s shown${status ? `, ${shown(status.framesPerSecond, 3)} rendered` : ''}`);
    write('Latency', median === null ? '–' : `${median.toFixed(0)} ms median, ${p95!.toFixed(0)} ms p95`);
    if (volume) write('Volume', `${volume.name}, ${volume.size.join(' × ')}, ${volume.type}, ${volume.range.map((v) => shown(v)).join(' … ')}`);
    write('Server', session.version ? `Goldthread ${session.version}, this is page ${session.viewer}, ${session.viewers} connected` : '–');
    latency.show(latencyCurve(latencies.recent));
    errors.show(errorCurve(session.errors.points, status?.target ?? null));
    if (!status) return;
    for (const [name, value] of factsOf(status)) write(name, value);
    ranks.show(status.ranks);
  };
  session.changed.listen((topic) => { if (topic === 'status' || topic === 'connection') update(); });
  window.setInterval(update, 500);
  const plot = (spark: HTMLElement | SVGElement, caption: string): HTMLElement =>
    el('div', { class: 'spark-frame' }, spark, el('span', { class: 'caption' }, caption));
  return [
    section('Progress', false, plot(errors.element, 'Estimated error since the last input, logarithmic'),
      facts, plot(latency.element, 'Latency of the last inputs')),
    section('Ranks', false, ranks.element),
  ];
}

function rankTable(): { element: HTMLElement; show: (ranks: readonly RankStatus[]) => void } {
  const body = el('tbody');
  const lost = el('p', { class: 'problem', hidden: true, role: 'status' });
  const head = el('tr', {}, ...['Rank', 'Role', 'Host', 'Busy', 'Tiles'].map((name) => el('th', { scope: 'col' }, name)));
  let rows: { row: HTMLElement; cells: HTMLElement[]; meter: HTMLElement; bar: HTMLElement }[] = [];
  const addRow = (): void => {
    const bar = el('span', { class: 'bar' });
    const meter = el('span', { class: 'meter', role: 'meter', aria: { valuemin: '0', valuemax: '100', label: 'Busy' } }, bar);
    const cells = [el('th', { scope: 'row' }), el('td'), el('td', { class: 'host' }), el('td', {}, meter), el('td', { class: 'right' })];
    const row = el('tr', {}, ...cells);
    rows.push({ row, cells, meter, bar });
    body.append(row);
  };
  return {
    element: el('div', {}, lost, el('table', { class: 'ranks' }, el('thead', {}, head), body)),
    show: (ranks) => {
      while (rows.length < ranks.length) addRow();
      for (const { row } of rows.splice(ranks.length)) row.remove();
      rows.forEach(({ row, cells, meter, bar }, i) => {
        const rank = ranks[i]!;
        const busy = Math.round(Math.min(Math.max(rank.busy, 0), 1) * 100);
        [String(rank.rank), rank.role, rank.host].forEach((value, j) => { cells[j]!.textContent = value; });
        cells[4]!.textContent = rank.state === 'lost' ? 'lost' : String(rank.tiles);
        row.className = rank.state;
        bar.style.width = `${busy}%`;
        meter.setAttribute('aria-valuenow', String(busy));
        meter.title = `${busy} % busy`;
      });
      const gone = ranks.filter(({ state }) => state === 'lost').map(({ rank }) => rank);
      lost.hidden = gone.length === 0;
      lost.textContent = gone.length > 0 ? `Lost: rank ${gone.join(', ')}. The others do its work.` : '';
    },
  };
}

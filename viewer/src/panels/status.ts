// SPDX-License-Identifier: Apache-2.0
// How it goes: pictures per second, latency, convergence, and what each rank is doing.

import { section } from '../controls';
import { el, set, shown, svg } from '../dom';
import type { RankStatus } from '../protocol';
import type { Session } from '../session';

const kSparkWidth = 300;
const kSparkHeight = 36;

export function statusPanel(session: Session): HTMLElement[] {
  const names = ['Pictures', 'Latency', 'Sample spacing', 'Converged', 'Estimated error', 'Rays', 'Epoch', 'Features', 'Kernel', 'Volume', 'Server'] as const;
  const cells = new Map(names.map((name) => [name, el('dd', {}, '–')]));
  const facts = el('dl', { class: 'facts' }, ...[...cells].flatMap(([name, cell]) => [el('dt', {}, name), cell]));
  const spark = sparkline();
  const ranks = rankTable();
  const write = (name: (typeof names)[number], value: string): void => {
    const cell = cells.get(name)!;
    if (cell.textContent !== value) cell.textContent = value;
  };
  const update = (): void => {
    const { status, volume, picture, latencies } = session;
    const [median, p95] = [latencies.quantile(0.5), latencies.quantile(0.95)];
    write('Pictures', `${shown(session.rate.perSecond(performance.now()), 3)} per s shown${status ? `, ${shown(status.framesPerSecond, 3)} rendered` : ''}`);
    write('Latency', median === null ? '–' : `${median.toFixed(0)} ms median, ${p95!.toFixed(0)} ms p95`);
    if (volume) write('Volume', `${volume.name}, ${volume.size.join(' × ')}, ${volume.type}, ${volume.range.map((v) => shown(v)).join(' … ')}`);
    write('Server', session.version ? `Goldthread ${session.version}, this is page ${session.viewer}, ${session.viewers} connected` : '–');
    spark.show(latencies.recent);
    if (!status) return;
    write('Sample spacing', `${shown(status.spacing)} px${picture?.final ? ', final' : ''}`);
    write('Converged', `${(Math.min(Math.max(status.converged, 0), 1) * 100).toFixed(0)} %`);
    write('Estimated error', status.estimatedError === null ? '–' : `${shown(status.estimatedError, 3)} / 255`);
    write('Rays', `${Math.round(status.rays).toLocaleString('en')} in ${shown(status.seconds, 3)} s`);
    write('Epoch', String(status.epoch));
    write('Features', status.features.join(', ') || 'none');
    write('Kernel', status.kernel || '–');
    ranks.show(status.ranks);
  };
  session.changed.listen((topic) => { if (topic === 'status' || topic === 'connection') update(); });
  window.setInterval(update, 500);
  return [
    section('Progress', false, el('div', { class: 'spark-frame' }, spark.element,
      el('span', { class: 'caption' }, 'Latency of the last inputs')), facts),
    section('Ranks', false, ranks.element),
  ];
}

function sparkline(): { element: SVGSVGElement; show: (values: readonly number[]) => void } {
  const line = svg('path', { class: 'spark' });
  const top = svg('text', { x: '99%', y: 11, 'text-anchor': 'end' });
  const element = svg('svg', { viewBox: `0 0 ${kSparkWidth} ${kSparkHeight}`, preserveAspectRatio: 'none', class: 'sparkline', 'aria-hidden': 'true' }, line);
  const frame = svg('svg', { class: 'spark-box', height: kSparkHeight, 'aria-hidden': 'true' }, element, top);
  return {
    element: frame,
    show: (values) => {
      const most = Math.max(1, ...values);
      const points = values.map((value, i) =>
        `${((i + 0.5) * kSparkWidth / Math.max(values.length, 30)).toFixed(1)} ${(kSparkHeight - 2 - (value / most) * (kSparkHeight - 4)).toFixed(1)}`);
      set(line, { d: points.length > 1 ? `M${points.join('L')}` : '' });
      top.textContent = values.length > 1 ? `${most.toFixed(0)} ms` : '';
    },
  };
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

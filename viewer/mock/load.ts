// SPDX-License-Identifier: Apache-2.0
// The mock's load: what a cluster might tell a page that watches. MOCK_WORKERS says how many workers it
// has, 4 by default.

const kDigits = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_';
const kBins = 128;
const kBinMs = 50;
const kWorkers = Number(process.env.MOCK_WORKERS ?? 4);
const kFirstWorker = 2;
/** As the mock's status says. */
const kLost = 4;
const kTile = 64;

/** How busy a rank is in a bin of time, 0 … 1: the same whenever it is asked for. */
function shareOf(rank: number, bin: number, moving: boolean): number {
  if (rank === kLost) return 0;
  if (rank === 0) return 0.04 + 0.03 * Math.abs(Math.sin(bin * 1.7));
  if (rank === 1) return 0.2 + 0.15 * Math.abs(Math.sin(bin * 0.9));
  const pause = !moving && bin % 40 < 6 ? 0 : 1;
  return pause * Math.min(1, 0.72 + 0.3 * Math.abs(Math.sin(rank * 2.3 + bin * 0.13)));
}

export function loadOf(now: number, moving: boolean): object {
  const newest = Math.floor(now / kBinMs);
  const ranks = Array.from({ length: kFirstWorker + kWorkers }, (_, rank) => {
    const shares = Array.from({ length: kBins }, (_bin, i) => shareOf(rank, newest - kBins + i, moving));
    const busy = shares.slice(-20).reduce((sum, share) => sum + share, 0) / 20;
    const role = rank === 0 ? 'master' : rank < kFirstWorker ? 'compositor' : 'worker';
    return {
      rank, role, lost: rank === kLost, busy, ...(role === 'worker' ? { view: 0.04 * busy } : {}),
      share: shares.map((share) => kDigits[Math.round(share * 63)]).join(''),
      age: now - newest * kBinMs, error: rank === 0 ? 0 : 0.2,
    };
  });
  const traffic = (kind: string, rate: number) => ({
    kind, messages: Math.round(now), total: Math.round((rate * now) / 1000), perSecond: rate,
  });
  return {
    type: 'load', bin: kBinMs, ranks,
    bytes: [traffic('Samples', 24e6), traffic('EncodedBand', 1.4e6), traffic('TilesDone', 61e3), traffic('RenderTiles', 21e3)],
  };
}

export function tilesOf(epoch: number, width: number, height: number): object {
  const tiles: number[] = [];
  for (let y = 0, i = 0; y < height; y += kTile) {
    for (let x = 0; x < width; x += kTile, ++i) {
      const size = [Math.min(kTile, width - x), Math.min(kTile, height - y)] as const;
      const away = Math.hypot(x + kTile / 2 - width / 2, y + kTile / 2 - height / 2) / Math.min(width, height);
      const cost = Math.max(0.05, 2 - 4 * away) * ((size[0] * size[1]) / kTile ** 2);
      tiles.push(x, y, ...size, kFirstWorker + ((i * 7 + (i >> 3)) % kWorkers), Math.round(1000 * cost) / 1000);
    }
  }
  return { type: 'tiles', epoch, width, height, tile: [kTile, kTile], tiles };
}

// SPDX-License-Identifier: Apache-2.0
// Dark or light: the system's choice until the user makes one, which is remembered.

import { button } from './controls';

const kKey = 'goldthread-theme';

type Theme = 'dark' | 'light';

function remembered(): Theme | null {
  try {
    const theme = localStorage.getItem(kKey);
    return theme === 'dark' || theme === 'light' ? theme : null;
  } catch {
    return null; // Storage may be forbidden; the system's choice holds then.
  }
}

export function themeButton(): HTMLButtonElement {
  const system = matchMedia('(prefers-color-scheme: light)');
  const now = (): Theme => remembered() ?? (document.documentElement.dataset.theme as Theme | undefined) ?? (system.matches ? 'light' : 'dark');
  const chosen = remembered();
  if (chosen) document.documentElement.dataset.theme = chosen;
  const toggle = button('Theme', 'Switch between dark and light', () => {
    const next = now() === 'dark' ? 'light' : 'dark';
    document.documentElement.dataset.theme = next;
    try {
      localStorage.setItem(kKey, next);
    } catch {
      // The choice holds until the page is closed.
    }
  }, 'quiet');
  return toggle;
}

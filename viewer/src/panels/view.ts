// SPDX-License-Identifier: Apache-2.0
// Standard views of LPS space (x to the patient's left, y to the back, z to the head) and the
// angle of view.

import { lookingAlong } from '../camera';
import { button, numberField, section } from '../controls';
import { el } from '../dom';
import type { Session } from '../session';
import type { Vec3 } from '../vector';

const kViews: readonly (readonly [string, string, Vec3, Vec3])[] = [
  ['Anterior', 'Seen from the front', [0, 1, 0], [0, 0, 1]],
  ['Posterior', 'Seen from the back', [0, -1, 0], [0, 0, 1]],
  ['Left', 'Seen from the patient’s left', [-1, 0, 0], [0, 0, 1]],
  ['Right', 'Seen from the patient’s right', [1, 0, 0], [0, 0, 1]],
  ['Superior', 'Seen from above', [0, 0, -1], [0, -1, 0]],
  ['Inferior', 'Seen from below', [0, 0, 1], [0, -1, 0]],
];

export function viewPanel(session: Session): HTMLElement {
  const look = (forward: Vec3, up: Vec3): void => {
    const { camera, volume } = session;
    if (camera && volume) session.moveCamera(lookingAlong(camera, volume.center, volume.radius, forward, up));
  };
  const fovy = numberField('Angle of view', { low: 1, high: 120, slider: true, unit: '°' }, (value) => {
    if (session.camera) session.moveCamera({ ...session.camera, fovy: value });
  });
  session.changed.listen((topic) => { if (topic === 'camera' && session.camera) fovy.show(session.camera.fovy); });
  return section('View', false,
    el('div', { class: 'grid3' }, ...kViews.map(([name, hint, forward, up]) => button(name, hint, () => look(forward, up)))),
    el('div', { class: 'buttons' },
      button('Frame the volume', 'Keep the direction and show all of it (r)', () => session.frameVolume()),
      button('Scene’s camera', 'Back to the camera that the session began with (Home)', () => {
        if (session.original) session.moveCamera(session.original.camera);
      })),
    fovy.element);
}

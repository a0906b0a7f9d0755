// Pointers on the picture: drag to move, wheel or two fingers to zoom, a tap to choose.
function addGestures(canvas, view, changed, tapped) {
  const pointers = new Map();
  let travelled = 0;
  const place = event => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const middle = () => {
    const all = [...pointers.values()];
    const [x, y] = [0, 1].map(k => all.reduce((sum, p) => sum + p[k], 0) / all.length);
    return {x, y, spread: all.length < 2 ? 0 : Math.hypot(all[0][0] - all[1][0], all[0][1] - all[1][1])};
  };
  canvas.addEventListener('pointerdown', event => {
    canvas.setPointerCapture(event.pointerId);
    if (pointers.size === 0) travelled = 0;
    pointers.set(event.pointerId, place(event));
    if (pointers.size > 1) travelled = Infinity;
  });
  canvas.addEventListener('pointermove', event => {
    if (!pointers.has(event.pointerId)) return;
    const before = middle();
    pointers.set(event.pointerId, place(event));
    const after = middle();
    travelled += Math.hypot(after.x - before.x, after.y - before.y);
    if (travelled < 5) return;  // a finger that taps is not quite still
    view.pan(after.x - before.x, after.y - before.y);
    if (before.spread > 0 && after.spread > 0) view.zoom(after.spread / before.spread, after.x, after.y);
    changed();
  });
  const end = event => {
    if (!pointers.delete(event.pointerId)) return;
    if (event.type === 'pointerup' && travelled < 5) tapped(...place(event));
  };
  canvas.addEventListener('pointerup', end);
  canvas.addEventListener('pointercancel', end);
  canvas.addEventListener('wheel', event => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    view.zoom(Math.exp(-0.0015 * lines * Math.max(-400, Math.min(400, event.deltaY))), ...place(event));
    changed();
  }, {passive: false});
}

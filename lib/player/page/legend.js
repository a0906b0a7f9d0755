// The scale of the colours, the scale of lengths and the outline of the chosen body.

// Bytes of the colours that the run gives as one text, six hexadecimal digits each.
function colourBytes(text) {
  return Uint8Array.from(text.match(/../g), pair => parseInt(pair, 16));
}
const cssColour = (rgb, i) => `rgb(${rgb[3 * i]}, ${rgb[3 * i + 1]}, ${rgb[3 * i + 2]})`;

function showScale(parent, quantity, rgb) {
  const unit = quantity.unit ? ` [${quantity.unit}]` : '';
  const caption = element('div', {className: 'caption'}, quantity.meaning + unit);
  if (quantity.names) {
    const keys = quantity.names.map((name, i) => {
      const swatch = element('i');
      swatch.style.background = cssColour(rgb, i);
      return element('span', {}, swatch, name);
    });
    parent.replaceChildren(caption, element('div', {className: 'keys'}, ...keys));
    return;
  }
  const bar = element('div', {className: 'bar'});
  const count = rgb.length / 3;
  const stops = Array.from({length: 33}, (_, i) => cssColour(rgb, Math.round(i / 32 * (count - 1))));
  bar.style.background = `linear-gradient(to right, ${stops.join(',')})`;
  const {low, high} = quantity;
  const inner = ticks(low, high, 5).filter(v => (v - low) / (high - low) > 0.12 && (v - low) / (high - low) < 0.88);
  const marks = [low, ...inner, high].map((value, i, all) => {
    const end = i === 0 ? 'first' : i === all.length - 1 ? 'last' : '';
    const sign = i === 0 && quantity.below ? '≤ ' : i === all.length - 1 && quantity.above ? '≥ ' : '';
    const mark = element('span', {className: end}, sign + shortNumber(value, 3));
    mark.style.left = `${100 * (value - low) / (high - low)}%`;
    return mark;
  });
  parent.replaceChildren(caption, bar, element('div', {className: 'ticks'}, ...marks));
}

// The width of the line of a force, and up to which force the width grows.
function showChainScale(parent, view, run) {
  const shown = view.shown.chains && run.array.chain_a.length > 0;
  parent.hidden = !shown;
  if (!shown) return;
  const sample = element('i');
  sample.style.height = `${view.chainWidth()}px`;
  const words = force => `${shortNumber(force * run.force_factor, 3)} ${run.force_unit}`;
  const limit = run.force_most > 3 * run.force_scale ? ` up to ${words(3 * run.force_scale)}` : '';
  parent.replaceChildren(sample, `normal force of a contact: ${words(run.force_scale)}; widths are proportional${limit}`);
}

// A round length that is about a sixth of the width, and the chosen body.
function drawMarks(canvas, view, places, frame, chosen) {
  const {width, height, pixels} = view, pen = canvas.getContext('2d');
  canvas.width = Math.round(width * pixels);
  canvas.height = Math.round(height * pixels);
  pen.scale(pixels, pixels);
  const wanted = width / 6 / view.scale, power = 10 ** Math.floor(Math.log10(wanted));
  const length = [5, 2, 1].map(m => m * power).find(l => l <= wanted) || power;
  const end = 12 + length * view.scale, y = height - 12, text = `${shortNumber(length)} m`;
  pen.font = '12px sans-serif';
  pen.fillStyle = 'rgba(255, 255, 255, 0.8)';
  pen.fillRect(6, y - 22, Math.max(end, 12 + pen.measureText(text).width), 30);
  pen.strokeStyle = pen.fillStyle = '#222';
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(12, y - 4);
  pen.lineTo(12, y);
  pen.lineTo(end, y);
  pen.lineTo(end, y - 4);
  pen.stroke();
  pen.fillText(text, 12, y - 8);
  if (chosen < 0 || !places.isThere(frame, chosen)) return;
  pen.beginPath();
  for (const line of places.outline(frame, chosen)) {
    line.forEach(([wx, wy], i) => {
      const [px, py] = view.toScreen(wx, wy);
      if (i) pen.lineTo(px, py); else pen.moveTo(px, py);
    });
  }
  pen.lineJoin = 'round';
  pen.strokeStyle = '#fff';
  pen.lineWidth = 4;
  pen.stroke();
  pen.strokeStyle = '#d55e00';
  pen.lineWidth = 2;
  pen.stroke();
}

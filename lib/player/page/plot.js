// Curves over time with a mark at the current one; a tap or a drag chooses the time.

// Colours that colour-blind readers can tell apart (Okabe and Ito).
const kLineColours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#56b4e9', '#e69f00', '#000000', '#8a8a00'];

// The last row that is not later than `time`.
function rowAt(times, time) {
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time) low = middle; else high = middle - 1;
  }
  return low;
}

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made && key !== 'list') made[key] = value; else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

class Plot {
  // `choices`: [{title, unit, lines: [{label, x, y}]}], one of which is shown at a time.
  constructor(parent, heading, choices, seek) {
    this.hidden = new Set();
    this.select = element('select', {ariaLabel: `quantity of ${heading}`});
    this.heading = element('h2', {}, heading);
    this.canvas = element('canvas', {className: 'plot'});
    this.canvas.setAttribute('role', 'img');
    this.now = element('div', {className: 'now'});
    this.legend = element('div', {className: 'legend'});
    this.section = element('section', {}, element('div', {className: 'heading'}, this.heading, this.select),
                           element('div', {className: 'frame'}, this.canvas, this.now), this.legend);
    parent.append(this.section);
    this.select.addEventListener('change', () => { this.show(this.select.value); this.draw(); });
    const at = event => {
      const box = this.canvas.getBoundingClientRect(), [low, high] = this.span;
      seek(low + (high - low) * (event.clientX - box.left - this.left) / (box.width - this.left - this.right));
    };
    this.canvas.addEventListener('pointerdown', event => { this.canvas.setPointerCapture(event.pointerId); at(event); });
    this.canvas.addEventListener('pointermove', event => { if (event.buttons) at(event); });
    this.time = 0;
    this.setChoices(choices);
  }

  setChoices(choices) {
    const before = this.select.value;
    this.choices = choices;
    this.select.replaceChildren(...choices.map((c, i) => element('option', {value: i}, c.unit && c.unit !== '1' ? `${c.title} [${c.unit}]` : c.title)));
    this.select.hidden = choices.length < 2;
    this.show(before in choices ? before : 0);
  }

  show(number) {
    this.select.value = number;
    this.choice = this.choices[number];
    this.values = [];
    const buttons = this.choice.lines.map((line, i) => {
      const value = element('span', {className: 'value'});
      this.values.push(value);
      const swatch = element('i');
      swatch.style.background = kLineColours[i % kLineColours.length];
      const button = element('button', {type: 'button', title: 'show or hide'}, swatch, line.label + ' ', value);
      const mark = () => button.setAttribute('aria-pressed', !this.hidden.has(line.label));
      button.addEventListener('click', () => {
        if (!this.hidden.delete(line.label)) this.hidden.add(line.label);
        mark();
        this.draw();
      });
      mark();
      return button;
    });
    this.legend.replaceChildren(...buttons);
    this.canvas.setAttribute('aria-label', `${this.heading.textContent}: ${this.choice.title} over time`);
  }

  lines() { return this.choice.lines.filter(line => !this.hidden.has(line.label)); }

  // Ends of both axes, from all values that are shown.
  ranges() {
    let [t0, t1, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const line of this.choice.lines) {
      if (line.x.length) [t0, t1] = [Math.min(t0, line.x[0]), Math.max(t1, line.x[line.x.length - 1])];
    }
    for (const line of this.lines()) {
      for (const y of line.y) if (Number.isFinite(y)) { if (y < low) low = y; if (y > high) high = y; }
    }
    if (!(t1 > t0)) t1 = t0 + 1;
    if (!(high >= low)) [low, high] = [0, 1];
    if (high === low) { const pad = Math.abs(high) || 1; low -= 0.5 * pad; high += 0.5 * pad; }
    const pad = 0.05 * (high - low);
    return [t0, t1, low - pad, high + pad];
  }

  // Axes and curves, which stay while the run plays.
  draw() {
    const box = this.canvas.getBoundingClientRect();
    if (box.width === 0) return;
    const pixels = window.devicePixelRatio || 1, [width, height] = [box.width, box.height];
    this.canvas.width = Math.round(width * pixels);
    this.canvas.height = Math.round(height * pixels);
    const pen = this.canvas.getContext('2d');
    pen.scale(pixels, pixels);
    pen.font = '11px sans-serif';
    const [t0, t1, low, high] = this.ranges();
    const marks = ticks(low, high, height / 35);
    this.digits = digitsBetween(low, high);
    this.left = 12 + Math.max(...marks.map(v => pen.measureText(shortNumber(v, this.digits)).width));
    this.right = 8;
    this.span = [t0, t1];
    this.across = width - this.left - this.right;
    const [top, bottom] = [16, 18];
    const px = t => this.left + (t - t0) / (t1 - t0) * this.across;
    const py = v => height - bottom - (v - low) / (high - low) * (height - top - bottom);
    this.axes(pen, {width, height, top, bottom, px, py, marks, t0, t1});
    for (const line of this.lines()) this.curve(pen, line, px, py);
    this.mark(this.time);
  }

  // The mark at a time, and the values there.
  mark(time) {
    this.time = time;
    if (!this.span) return;
    const [t0, t1] = this.span;
    this.now.style.left = `${this.left + (time - t0) / (t1 - t0) * this.across}px`;
    this.choice.lines.forEach((line, i) => {
      this.values[i].textContent = line.x.length ? shortNumber(line.y[rowAt(line.x, time)], this.digits) : '–';
    });
  }

  axes(pen, {width, height, top, bottom, px, py, marks, t0, t1}) {
    pen.fillStyle = '#333';
    pen.strokeStyle = '#ddd';
    pen.lineWidth = 1;
    pen.textBaseline = 'middle';
    pen.textAlign = 'right';
    for (const value of marks) {
      pen.beginPath();
      pen.moveTo(this.left, py(value));
      pen.lineTo(width - this.right, py(value));
      pen.stroke();
      pen.fillText(shortNumber(value, this.digits), this.left - 4, py(value));
    }
    pen.textBaseline = 'alphabetic';
    pen.textAlign = 'left';
    const {title, unit} = this.choice;
    pen.fillText(unit && unit !== '1' ? `${title} [${unit}]` : title, 4, 11);
    pen.textAlign = 'center';
    for (const t of ticks(t0, t1, width / 60)) {
      const text = shortNumber(t, digitsBetween(t0, t1)), half = pen.measureText(text).width / 2;
      pen.fillText(text, Math.min(width - half - 1, px(t)), height - 5);
    }
    pen.textAlign = 'right';
    pen.fillText('time [s]', width - this.right, 11);
    pen.strokeStyle = '#888';
    pen.strokeRect(this.left, top, width - this.left - this.right, height - top - bottom);
  }

  curve(pen, line, px, py) {
    pen.strokeStyle = kLineColours[this.choice.lines.indexOf(line) % kLineColours.length];
    pen.lineWidth = 1.5;
    pen.lineJoin = 'round';
    pen.beginPath();
    let open = false;
    for (let i = 0; i < line.x.length; ++i) {
      if (!Number.isFinite(line.y[i])) { open = false; continue; }
      if (open) pen.lineTo(px(line.x[i]), py(line.y[i])); else pen.moveTo(px(line.x[i]), py(line.y[i]));
      open = true;
    }
    pen.stroke();
  }
}

// The page: one state (frame, colour, chosen body), which controls and keys change and which the
// address keeps, as in #t=0.5&colour=pressure&body=stone-3&chains=1&play=1.

const page = id => document.getElementById(id);

class Player {
  constructor(run) {
    this.run = run;
    this.frame = 0;
    this.time = run.times[0];
    this.chosen = -1;
    this.element = -1;
    this.playing = false;
    this.rate = 20;  // frames per second
    this.places = new Places(run);
    this.drawn = {count: 0, milliseconds: 0};
    this.maps = Object.fromEntries(Object.entries(run.colours).map(([name, text]) => [name, colourBytes(text)]));
    this.view = new View(page('bodies'), run, geometryOf(run));
    this.view.onRestored = () => { this.choose(this.quantity.name); this.show(this.frame); };
    this.addControls();
    this.addPlots();
    page('message').hidden = true;
    ['controls', 'beside', 'zoom'].forEach(id => { page(id).hidden = false; });
    this.view.resize();
    this.view.fit(run.box);
    this.drawPlots();
    this.choose(run.quantities[0].name);
    this.show(0);
    this.followAddress();
    window.addEventListener('hashchange', () => this.followAddress());
    new ResizeObserver(() => this.resized()).observe(page('stage'));
  }

  addControls() {
    const {run, view} = this;
    page('slider').max = run.frames - 1;
    page('slider').addEventListener('input', () => { this.pause(); this.show(Number(page('slider').value)); this.keep(); });
    page('play').addEventListener('click', () => this.toggle());
    page('back').addEventListener('click', () => this.step(-1));
    page('forth').addEventListener('click', () => this.step(1));
    page('colour').append(...run.quantities.map(q => element('option', {value: q.name}, q.meaning)));
    page('colour').addEventListener('change', () => { this.choose(page('colour').value); this.show(this.frame); this.keep(); });
    page('speed').append(...[1, 2, 5, 10, 20, 30, 60].map(r => element('option', {value: r}, String(r))));
    page('speed').value = this.rate;
    page('speed').addEventListener('change', () => { this.rate = Number(page('speed').value); this.start(); });
    const shown = name => page(name).addEventListener('change', () => {
      view.shown[name] = page(name).checked;
      this.show(this.frame);
      this.keep();
    });
    ['chains', 'outlines'].forEach(shown);
    page('chains-label').hidden = run.array.chain_a.length === 0;
    page('closer').addEventListener('click', () => this.zoom(1.5));
    page('farther').addEventListener('click', () => this.zoom(1 / 1.5));
    page('whole').addEventListener('click', () => { view.fit(run.box); this.redraw(); });
    page('body-close').addEventListener('click', () => this.pick(null));
    page('bodies').addEventListener('dblclick', () => { view.fit(run.box); this.redraw(); });
    addGestures(page('bodies'), view, () => this.redraw(), (px, py) => this.pick(this.places.at(this.frame, ...view.toWorld(px, py))));
    window.addEventListener('keydown', event => this.key(event));
  }

  addPlots() {
    const {run} = this, seek = time => { this.pause(); this.show(this.frameAt(time)); this.keep(); };
    const column = (number, offset = 0) => {
      const values = run.array[`column_${number}`];
      return offset ? Float64Array.from(values, v => v + offset) : values;
    };
    this.plots = run.plots.map(group => new Plot(page('plots'), group.title, group.choices.map(choice => ({
      ...choice, lines: choice.lines.map(line => ({label: line.label, x: column(line.time), y: column(line.column, line.offset)}))
    })), seek));
    this.seek = seek;
    const bodies = run.bodies.length, meshed = run.elements ? `, ${run.elements} elements` : '';
    page('about').textContent = `${bodies} ${bodies === 1 ? 'body' : 'bodies'}${meshed}; ${run.frames} frames from ` +
        `${shortNumber(run.times[0])} s to ${shortNumber(run.times[run.frames - 1])} s; ${run.program}`;
  }

  frameAt(time) {
    const {times} = this.run, before = rowAt(times, time), after = Math.min(before + 1, times.length - 1);
    return Math.abs(times[after] - time) < Math.abs(times[before] - time) ? after : before;
  }

  // The colour of a quantity, from now on.
  choose(name) {
    this.quantity = this.run.quantities.find(q => q.name === name) || this.run.quantities[0];
    const {quantity} = this, rgb = this.maps[quantity.colours];
    page('colour').value = quantity.name;
    this.view.range = [quantity.low, quantity.high > quantity.low ? quantity.high : quantity.low + 1];
    this.view.setColours(rgb);
    showScale(page('scale'), quantity, rgb);
  }

  value(quantity, frame, item) {
    const values = this.run.array[`value_${quantity.name}`];
    return values[(quantity.constant ? 0 : frame * this.run.items) + item];
  }

  show(frame) {
    const {run, view} = this;
    this.frame = Math.max(0, Math.min(run.frames - 1, frame));
    this.time = run.times[this.frame];
    this.places.fillPoses(this.frame, view.poses.numbers);
    view.poses.send();
    if (run.nodes) {
      this.places.fillNodes(this.frame, view.nodes.numbers);
      view.nodes.send();
    }
    const values = run.array[`value_${this.quantity.name}`], first = this.quantity.constant ? 0 : this.frame * run.items;
    view.values.numbers.set(values.subarray(first, first + run.items));
    view.values.send();
    if (view.shown.chains) {
      const {ends, forces} = this.places.chains(this.frame);
      view.chains.send(ends, forces);
    }
    page('slider').value = this.frame;
    page('slider').setAttribute('aria-valuetext', `${shortNumber(this.time)} s`);
    page('clock').textContent = `t = ${shortNumber(this.time)} s (${this.frame + 1} of ${run.frames})`;
    this.redraw();
    this.plots.forEach(plot => plot.mark(this.time));
    this.showBody();
  }

  redraw() {
    const start = performance.now();
    this.view.draw();
    showChainScale(page('chain-scale'), this.view, this.run);
    drawMarks(page('marks'), this.view, this.places, this.frame, this.chosen);
    this.drawn.milliseconds = performance.now() - start;
    ++this.drawn.count;
  }

  resized() {
    const {view} = this, before = view.fitted, scale = view.scale, centre = view.centre;
    view.resize();
    view.fit(this.run.box);
    if (scale !== before) [view.scale, view.centre] = [scale * view.fitted / before, centre];
    this.redraw();
    this.drawPlots();
  }

  drawPlots() { for (const plot of [...this.plots, this.bodyPlot]) plot?.draw(); }
  zoom(factor) { this.view.zoom(factor); this.redraw(); }
  step(by) { this.pause(); this.show(this.frame + by); this.keep(); }
  toggle() { if (this.playing) { this.pause(); this.keep(); } else this.play(); }
  play() {
    if (this.frame === this.run.frames - 1) this.show(0);
    this.playing = true;
    page('play').textContent = 'Pause';
    this.start();
    requestAnimationFrame(now => this.advance(now));
  }
  pause() { this.playing = false; page('play').textContent = 'Play'; }
  start() { this.from = {now: performance.now(), frame: this.frame}; }
  advance(now) {
    if (!this.playing) return;
    const due = this.from.frame + Math.floor(Math.max(0, now - this.from.now) * this.rate / 1000);
    if (due > this.frame) this.show(due);
    if (this.frame < this.run.frames - 1) return void requestAnimationFrame(next => this.advance(next));
    this.pause();
    this.keep();
  }

  // Shows the numbers of a body, or of none.
  pick(found) {
    this.chosen = found ? found.body : -1;
    this.element = found ? found.element : -1;
    page('body').hidden = !found;
    if (found) {
      page('body-name').textContent = this.run.bodies[this.chosen];
      const choices = this.histories();
      if (this.bodyPlot) this.bodyPlot.setChoices(choices);
      else this.bodyPlot = new Plot(page('body-plot'), 'over the run', choices, this.seek);
      this.bodyPlot.draw();
    }
    this.redraw();
    this.showBody();
    this.keep();
  }

  // What the frames say of the chosen body.
  histories() {
    const {run} = this, frames = run.times.map((_, k) => k);
    const there = (k, value) => this.places.isThere(k, this.chosen) ? value : NaN;
    const line = (title, unit, value) => ({title, unit, lines: [{label: title, x: run.times, y: frames.map(k => there(k, value(k)))}]});
    const item = this.element < 0 ? this.chosen : run.bodies.length + this.element;
    const known = v => v > 1e38 ? NaN : v;
    const pose = (k, part) => this.places.pose(k, this.chosen)[part] + (part < 2 ? run.origin[part] : 0);
    return [...run.quantities.filter(q => !q.names && !q.constant).map(q => line(q.meaning, q.unit, k => known(this.value(q, k, item)))),
            line('x of the centroid', 'm', k => pose(k, 0)), line('y of the centroid', 'm', k => pose(k, 1))];
  }

  showBody() {
    if (this.chosen < 0) return;
    const {run, chosen, frame} = this, rows = [];
    if (!this.places.isThere(frame, chosen)) {
      rows.push(['', 'not there at this time']);
    } else {
      const [x, y] = this.places.pose(frame, chosen);
      const decimals = Math.max(0, -Math.ceil(Math.log10(run.length_step)));  // no more than are stored
      [x, y].forEach((v, i) => rows.push(
          [`${'xy'[i]} of the centroid`, `${Number((v + run.origin[i]).toFixed(decimals))} m`.replace('-', '−')]));
      const item = this.element < 0 ? chosen : run.bodies.length + this.element;
      for (const quantity of run.quantities) {
        const value = this.value(quantity, frame, item);
        const text = value > 1e38 ? '–' : quantity.names ? quantity.names[value] : `${shortNumber(value)} ${quantity.unit}`;
        rows.push([quantity.meaning, text]);
      }
      if (this.element >= 0) rows.push(['element (its stresses are shown)', String(this.element)]);
    }
    page('body-numbers').replaceChildren(...rows.map(cells => element('tr', {}, ...cells.map(c => element('td', {}, c)))));
    this.bodyPlot.mark(this.time);
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const {target} = event, name = event.key.toLowerCase();
    if (target.matches('select')) return;
    if (name === ' ' && target.matches('button, summary, input[type=checkbox]')) return;
    const next = () => this.run.quantities[(this.run.quantities.indexOf(this.quantity) + 1) % this.run.quantities.length];
    const actions = {
      ' ': () => this.toggle(), arrowleft: () => this.step(-1), arrowright: () => this.step(1),
      home: () => this.step(-this.run.frames), end: () => this.step(this.run.frames),
      '+': () => this.zoom(1.5), '=': () => this.zoom(1.5), '-': () => this.zoom(1 / 1.5),
      0: () => page('whole').click(), c: () => { this.choose(next().name); this.show(this.frame); this.keep(); },
      k: () => page('chains').click(), o: () => page('outlines').click(), escape: () => this.pick(null)
    };
    if (!actions[name]) return;
    event.preventDefault();
    actions[name]();
  }

  // Writes the state into the address, without a new entry in the browser's history.
  keep() {
    if (this.playing || this.following) return;
    const words = new URLSearchParams({t: String(this.time), colour: this.quantity.name});
    if (this.view.shown.chains) words.set('chains', '1');
    if (!this.view.shown.outlines) words.set('outlines', '0');
    if (this.chosen >= 0) words.set('body', this.run.bodies[this.chosen]);
    history.replaceState(null, '', '#' + words);
  }

  followAddress() {
    const words = new URLSearchParams(location.hash.slice(1)), time = Number(words.get('t') ?? NaN);
    this.following = true;
    this.pause();
    this.choose(words.get('colour') ?? this.quantity.name);
    for (const name of ['chains', 'outlines']) {
      if (words.has(name)) page(name).checked = this.view.shown[name] = words.get(name) !== '0';
    }
    const body = this.run.bodies.indexOf(words.get('body') ?? '');
    this.show(Number.isFinite(time) && words.has('t') ? this.frameAt(time) : this.frame);
    if (body >= 0) this.pick({body, element: -1});
    this.following = false;
    if (words.get('play') === '1') this.play();
  }
}

try {
  window.player = new Player(await readRun());
} catch (error) {
  page('message').hidden = false;
  page('message').textContent = `The run cannot be shown: ${error.message}`;
  throw error;
}

// The picture of the bodies, drawn by WebGL, and where the reader looks.

const kTableWidth = 1024;  // as in the shaders

// A table of numbers for the shaders, `parts` of them in each entry.
class Table {
  constructor(gl, unit, parts, count) {
    this.gl = gl;
    this.unit = unit;
    this.formats = parts === 4 ? [gl.RGBA32F, gl.RGBA] : parts === 2 ? [gl.RG32F, gl.RG] : [gl.R32F, gl.RED];
    this.rows = Math.max(1, Math.ceil(count / kTableWidth));
    this.numbers = new Float32Array(this.rows * kTableWidth * parts);
    this.texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.texStorage2D(gl.TEXTURE_2D, 1, this.formats[0], kTableWidth, this.rows);
  }
  use() {
    this.gl.activeTexture(this.gl.TEXTURE0 + this.unit);
    this.gl.bindTexture(this.gl.TEXTURE_2D, this.texture);
  }
  send() {
    const {gl} = this;
    this.use();
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, kTableWidth, this.rows, this.formats[1], gl.FLOAT, this.numbers);
  }
}

// Lines as tables of their ends and owners.
class Lines {
  constructor(gl, room) {
    this.ends = new Table(gl, 4, 4, room);
    this.owners = new Table(gl, 5, 1, room);
    this.count = 0;
  }
  send(ends, owners) {
    this.ends.numbers.set(ends);
    this.owners.numbers.set(owners);
    this.ends.send();
    this.owners.send();
    this.count = owners.length;
    return this;
  }
}

// Buffers with the numbers of each corner; `layout` lists their sizes and the numbers.
function vertexArray(gl, layout) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  layout.forEach(([size, numbers], location) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, 0, 0);
  });
  return array;
}

class View {
  constructor(canvas, run, geometry) {
    this.canvas = canvas;
    this.run = run;
    this.geometry = geometry;
    this.centre = [0, 0];
    this.scale = 1;  // CSS pixels per m
    this.width = this.height = 1;
    this.pixels = 1;
    this.range = [0, 1];
    this.shown = {outlines: true, chains: false};
    const gl = canvas.getContext('webgl2', {antialias: true, alpha: false, preserveDrawingBuffer: true});
    if (!gl) throw new Error('This browser has no WebGL 2, with which the bodies are drawn.');
    this.gl = gl;
    canvas.addEventListener('webglcontextlost', event => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => { this.prepare(); this.onRestored?.(); });
    this.prepare();
  }

  prepare() {
    const {gl, run, geometry} = this;
    this.fill = compiled(gl, kFillVertex, kFillFragment);
    this.edges = compiled(gl, kEdgeVertex, kPlainFragment);
    this.lines = compiled(gl, kChainVertex, kPlainFragment);
    this.poses = new Table(gl, 0, 4, run.bodies.length);
    this.nodes = new Table(gl, 1, 2, run.nodes);
    this.values = new Table(gl, 2, 1, run.items);
    this.colours = gl.createTexture();
    gl.activeTexture(gl.TEXTURE3);
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    const solid = part => ({array: vertexArray(gl, [[2, part.corners], [2, part.owners]]), count: part.owners.length / 2});
    const lines = part => new Lines(gl, part.bodies.length).send(part.ends, part.bodies);
    this.parts = [
      {meshed: false, solid: solid(geometry.rigid), outline: lines(geometry.rigidEdges)},
      {meshed: true, solid: solid(geometry.elements), outline: lines(geometry.meshEdges),
       inner: lines(geometry.innerEdges)}
    ];
    this.chains = new Lines(gl, geometry.mostChains);
    this.noArray = gl.createVertexArray();
  }

  setColours(rgb) {  // bytes
    const {gl} = this;
    gl.activeTexture(gl.TEXTURE3);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, rgb.length / 3, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, rgb);
  }

  // The size of the canvas, in CSS pixels.
  resize() {
    const box = this.canvas.getBoundingClientRect();
    [this.width, this.height] = [Math.max(1, box.width), Math.max(1, box.height)];
    this.pixels = Math.min(3, window.devicePixelRatio || 1);
    this.canvas.width = Math.round(this.width * this.pixels);
    this.canvas.height = Math.round(this.height * this.pixels);
  }

  fit(box) {
    const [x0, y0, x1, y1] = box;
    this.centre = [(x0 + x1) / 2, (y0 + y1) / 2];
    this.fitted = 0.94 * Math.min(this.width / Math.max(x1 - x0, 1e-300), this.height / Math.max(y1 - y0, 1e-300));
    this.scale = this.fitted;
  }

  toScreen(x, y) {
    return [this.width / 2 + (x - this.centre[0]) * this.scale, this.height / 2 - (y - this.centre[1]) * this.scale];
  }
  toWorld(px, py) {
    return [this.centre[0] + (px - this.width / 2) / this.scale, this.centre[1] - (py - this.height / 2) / this.scale];
  }

  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = this.toWorld(px, py);
    // Closer than this the rounding of the stored places would be seen.
    const closest = Math.max(this.fitted * 10, 0.5 / this.run.length_step);
    this.scale = Math.min(closest, Math.max(this.fitted / 10, this.scale * factor));
    this.centre = [x - (px - this.width / 2) / this.scale, y + (py - this.height / 2) / this.scale];
  }
  pan(dx, dy) {
    this.centre = [this.centre[0] - dx / this.scale, this.centre[1] + dy / this.scale];
  }

  use(shader, meshed) {
    const {gl} = this, u = shader.uniforms;
    gl.useProgram(shader.program);
    const scale = [2 * this.scale / this.width, 2 * this.scale / this.height];
    gl.uniform2f(u.viewCentre, ...this.centre);
    gl.uniform2f(u.viewScale, ...scale);
    if (u.meshed) gl.uniform1i(u.meshed, meshed ? 1 : 0);
    ['poses', 'nodes', 'values', 'colours', 'ends', 'owners'].forEach((name, unit) => { if (u[name]) gl.uniform1i(u[name], unit); });
    if (u.pixel) gl.uniform2f(u.pixel, 2 / this.canvas.width, 2 / this.canvas.height);
    return u;
  }

  drawLines(shader, part, meshed, width, ink) {
    if (part.count === 0 || width <= 0) return;
    const {gl} = this, u = this.use(shader, meshed);
    gl.uniform1f(u.width, width * this.pixels);
    gl.uniform4f(u.ink, ...ink);
    part.ends.use();
    part.owners.use();
    gl.bindVertexArray(this.noArray);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * part.count);
  }

  draw() {
    const {gl} = this;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const size = this.run.body_size * this.scale;  // of a usual body, pixels
    // Outlines of bodies that are a few pixels wide would cover them.
    const strength = Math.min(1, Math.max(0, (size - 4) / 10));
    for (const part of this.parts) {
      if (part.solid.count === 0) continue;
      const u = this.use(this.fill, part.meshed);
      gl.uniform2f(u.range, ...this.range);
      gl.uniform1f(u.pale, this.shown.chains ? 0.6 : 0);
      gl.bindVertexArray(part.solid.array);
      gl.drawArrays(gl.TRIANGLES, 0, part.solid.count);
      if (!this.shown.outlines || strength < 0.1) continue;
      if (part.inner && strength === 1) this.drawLines(this.edges, part.inner, true, 0.5, [0, 0, 0, 0.25]);
      this.drawLines(this.edges, part.outline, part.meshed, 0.4 + 0.6 * strength, [0.1, 0.1, 0.1, 0.9 * strength]);
    }
    if (this.shown.chains) this.drawLines(this.lines, this.chains, false, this.chainWidth(), [0.65, 0.05, 0.1, 1]);
  }

  // Of a line of the force 1, CSS pixels: small beside the bodies, and beside the picture where they are large.
  chainWidth() {
    return Math.min(0.35 * this.run.body_size * this.scale, 4 * Math.max(1, Math.sqrt(this.scale / this.fitted)));
  }
}

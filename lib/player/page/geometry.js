// The shapes of the bodies, and their places in a frame. Lengths are m from the middle of the run.

// The first corner of each ring of a body, and the end of each: the outer ring and then the holes.
function ringsOf(array, body) {
  const starts = [array.ring_first[body]];
  for (let i = array.body_holes[body]; i < array.body_holes[body + 1]; ++i) starts.push(array.hole_first[i]);
  return starts.map((first, k) => [first, k + 1 < starts.length ? starts[k + 1] : array.ring_first[body + 1]]);
}

// What is drawn: corners of triangles with their owners, and edges.
function geometryOf(run) {
  const {array} = run, bodies = run.bodies.length;
  const bodyOfCorner = new Int32Array(array.ring_x.length);
  const edgeCount = array.ring_x.length;
  const rigidEdges = {ends: new Float32Array(4 * edgeCount), bodies: new Float32Array(edgeCount)};
  for (let b = 0; b < bodies; ++b) {
    for (const [first, end] of ringsOf(array, b)) {
      for (let i = first; i < end; ++i) {
        const next = i + 1 < end ? i + 1 : first;
        bodyOfCorner[i] = b;
        rigidEdges.bodies[i] = b;
        rigidEdges.ends.set([array.ring_x[i], array.ring_y[i], array.ring_x[next], array.ring_y[next]], 4 * i);
      }
    }
  }
  const solid = (triangles, corner, owner) => {
    const part = {corners: new Float32Array(2 * triangles.length), owners: new Float32Array(2 * triangles.length)};
    for (let i = 0; i < triangles.length; ++i) {
      part.corners.set(corner(triangles[i]), 2 * i);
      part.owners.set(owner(i), 2 * i);
    }
    return part;
  };
  const nodeEdges = (nodes, owners) => {
    const part = {ends: new Float32Array(2 * nodes.length), bodies: new Float32Array(owners)};
    for (let i = 0; i < nodes.length; ++i) part.ends[2 * i] = nodes[i];
    return part;
  };
  let mostChains = 0;  // lines in a frame: two for each contact
  for (let k = 0; k < run.frames; ++k) mostChains = Math.max(mostChains, 2 * (array.chain_first[k + 1] - array.chain_first[k]));
  return {
    mostChains,
    rigidEdges,
    rigid: solid(array.triangles, i => [array.ring_x[i], array.ring_y[i]],
                 i => { const b = bodyOfCorner[array.triangles[i]]; return [b, b]; }),
    elements: solid(array.element_triangles, n => [n, 0], i => {
      const e = array.triangle_element[Math.floor(i / 3)];
      return [array.element_body[e], bodies + e];
    }),
    meshEdges: nodeEdges(array.boundary_nodes, array.boundary_body),
    innerEdges: nodeEdges(array.inner_nodes, array.inner_body)
  };
}

// Where everything is in a frame.
class Places {
  constructor(run) { this.run = run; }
  isThere(frame, body) { return this.run.array.present[frame * this.run.bodies.length + body] > 0; }
  // x, y, angle
  pose(frame, body) {
    const {array, length_step, angle_step} = this.run, i = frame * this.run.bodies.length + body;
    return [array.x[i] * length_step, array.y[i] * length_step, array.angle[i] * angle_step];
  }
  node(frame, node) {
    const {array, length_step, nodes} = this.run;
    return [array.node_x[frame * nodes + node] * length_step, array.node_y[frame * nodes + node] * length_step];
  }
  fillPoses(frame, numbers) {
    const {array, length_step, angle_step, bodies} = this.run, first = frame * bodies.length;
    for (let b = 0; b < bodies.length; ++b) {
      numbers[4 * b] = array.x[first + b] * length_step;
      numbers[4 * b + 1] = array.y[first + b] * length_step;
      const angle = array.angle[first + b] * angle_step, present = array.present[first + b];
      numbers[4 * b + 2] = present * Math.cos(angle);
      numbers[4 * b + 3] = present * Math.sin(angle);
    }
  }
  fillNodes(frame, numbers) {
    const {array, length_step, nodes} = this.run, first = frame * nodes;
    for (let n = 0; n < nodes; ++n) {
      numbers[2 * n] = array.node_x[first + n] * length_step;
      numbers[2 * n + 1] = array.node_y[first + n] * length_step;
    }
  }

  // The lines of force in a frame: ends, and forces over the scale of forces.
  chains(frame) {
    const {array, length_step, force_scale} = this.run;
    const first = array.chain_first[frame], end = array.chain_first[frame + 1];
    const ends = new Float32Array(8 * (end - first)), forces = new Float32Array(2 * (end - first));
    for (let i = first; i < end; ++i) {
      const a = array.chain_a[i], b = array.chain_b[i], through = array.chain_ends[i];
      const near = this.pose(frame, array.chain_near[i] ? b : a);
      const point = [near[0] + array.chain_x[i] * 8 * length_step, near[1] + array.chain_y[i] * 8 * length_step];
      [a, b].forEach((body, side) => {
        if (!(through & (1 << side))) return;
        const k = 2 * (i - first) + side, pose = this.pose(frame, body);
        ends.set([pose[0], pose[1], point[0], point[1]], 4 * k);
        forces[k] = array.chain_force[i] / force_scale;
      });
    }
    return {ends, forces};
  }

  // Lines around a body.
  outline(frame, body) {
    const {array} = this.run;
    if (array.ring_first[body] < array.ring_first[body + 1]) {
      const [x, y, angle] = this.pose(frame, body), c = Math.cos(angle), s = Math.sin(angle);
      return ringsOf(array, body).map(([first, end]) => {
        const ring = [];
        for (let i = first; i <= end; ++i) {
          const lx = array.ring_x[i < end ? i : first], ly = array.ring_y[i < end ? i : first];
          ring.push([x + c * lx - s * ly, y + s * lx + c * ly]);
        }
        return ring;
      });
    }
    const lines = [];
    array.boundary_body.forEach((owner, i) => {
      if (owner === body) lines.push([0, 1].map(k => this.node(frame, array.boundary_nodes[2 * i + k])));
    });
    return lines;
  }

  // The body at a point in a frame, and its element, or nothing.
  at(frame, x, y) {
    const {array, bodies} = this.run;
    for (let e = 0; e + 1 < array.element_first.length; ++e) {
      const body = array.element_body[e];
      if (!this.isThere(frame, body)) continue;
      const ring = [];
      for (let i = array.element_first[e]; i < array.element_first[e + 1]; ++i) {
        ring.push(this.node(frame, array.element_nodes[i]));
      }
      if (isInside(ring, x, y)) return {body, element: e};
    }
    for (let body = bodies.length - 1; body >= 0; --body) {
      if (array.ring_first[body] === array.ring_first[body + 1] || !this.isThere(frame, body)) continue;
      const [cx, cy, angle] = this.pose(frame, body);
      const c = Math.cos(angle), s = Math.sin(angle);
      const lx = c * (x - cx) + s * (y - cy), ly = c * (y - cy) - s * (x - cx);
      const around = ringsOf(array, body).filter(([first, end]) => {
        const ring = [];
        for (let i = first; i < end; ++i) ring.push([array.ring_x[i], array.ring_y[i]]);
        return isInside(ring, lx, ly);
      });
      if (around.length % 2 === 1) return {body, element: -1};  // not in a hole
    }
    return null;
  }
}

function isInside(ring, x, y) {
  let inside = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
    const [xi, yi] = ring[i], [xj, yj] = ring[j];
    if (yi > y !== yj > y && x < (xj - xi) * (y - yi) / (yj - yi) + xi) inside = !inside;
  }
  return inside;
}

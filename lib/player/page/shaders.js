// What the graphics processor does: it places the corners of bodies and elements by the poses and
// nodes of the frame at hand, which are textures, so that a frame costs one upload of these.

// Where the corner of a rigid body or a node is, in metres from the middle of the run.
const kPlace = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D poses;   // x, y, cosine and sine of the angle; these are 0 if the body is not there
uniform sampler2D nodes;   // x, y
uniform sampler2D values;  // of bodies and elements
uniform bool meshed;
uniform vec2 viewCentre, viewScale;  // m; from m to the square from -1 to 1
const int kWidth = 1024;
vec4 texel(sampler2D table, int i) { return texelFetch(table, ivec2(i % kWidth, i / kWidth), 0); }
vec2 placeOf(vec2 local, int body) {
  if (meshed) return texel(nodes, int(local.x)).xy;
  vec4 pose = texel(poses, body);
  return pose.xy + local.x * pose.zw + local.y * vec2(-pose.w, pose.z);
}
bool isThere(int body) { return texel(poses, body).zw != vec2(0.0); }
vec4 onScreen(vec2 place) { return vec4((place - viewCentre) * viewScale, 0.0, 1.0); }
`;

const kFillVertex = kPlace + `
layout(location = 0) in vec2 local;
layout(location = 1) in vec2 owner;  // body, and body or element whose value counts
uniform vec2 range;                  // ends of the colour scale
flat out float share;
void main() {
  int body = int(owner.x);
  gl_Position = isThere(body) ? onScreen(placeOf(local, body)) : vec4(2.0, 2.0, 2.0, 1.0);
  float value = texel(values, int(owner.y)).x;
  share = value > 1e38 ? -1.0 : clamp((value - range.x) / (range.y - range.x), 0.0, 1.0);
}`;

const kFillFragment = `#version 300 es
precision highp float;
uniform sampler2D colours;
uniform float pale;  // share of white
flat in float share;
out vec4 colour;
void main() {
  // The middles of the first and the last colour are the ends of the scale.
  int last = textureSize(colours, 0).x - 1;
  vec3 own = share < 0.0 ? vec3(0.8) : texelFetch(colours, ivec2(int(share * float(last) + 0.5), 0), 0).rgb;
  colour = vec4(mix(own, vec3(1.0), pale), 1.0);
}`;

// A line is two triangles. Their corners are counted; no numbers are sent for them.
const kCorner = `
uniform sampler2D ends;    // of each line
uniform sampler2D owners;  // its body; of a chain, the force
uniform vec2 pixel;        // size of a pixel in the square from -1 to 1
const vec2 kCorners[6] = vec2[6](vec2(0, -1), vec2(0, 1), vec2(1, -1), vec2(1, -1), vec2(0, 1), vec2(1, 1));
const vec4 kNowhere = vec4(2.0, 2.0, 2.0, 1.0);
vec4 widened(vec4 a, vec4 b, float width) {
  vec2 corner = kCorners[gl_VertexID % 6];  // along: 0 or 1; across: -1 or 1
  vec2 along = (b.xy - a.xy) / pixel;
  float size = length(along);
  vec2 unit = size > 0.0 ? along / size : vec2(1.0, 0.0);
  vec2 across = vec2(-unit.y, unit.x);
  vec2 shift = (across * corner.y + unit * (2.0 * corner.x - 1.0)) * 0.5 * width;
  return vec4(mix(a.xy, b.xy, corner.x) + shift * pixel, 0.0, 1.0);
}`;

// Ends are places in the body, or two nodes in x and z.
const kEdgeVertex = kPlace + kCorner + `
uniform float width;  // pixels
void main() {
  vec4 both = texel(ends, gl_VertexID / 6);
  int body = int(texel(owners, gl_VertexID / 6).x);
  gl_Position = isThere(body) ? widened(onScreen(placeOf(both.xy, body)), onScreen(placeOf(both.zw, body)), width)
                              : kNowhere;
}`;

const kChainVertex = kPlace + kCorner + `
uniform float width;  // pixels of the force 1; lines do not get wider than thrice that (showChainScale says so)
void main() {
  vec4 both = texel(ends, gl_VertexID / 6);
  float force = texel(owners, gl_VertexID / 6).x;
  gl_Position = force > 0.0 ? widened(onScreen(both.xy), onScreen(both.zw), clamp(force * width, 0.35, 3.0 * width))
                            : kNowhere;
}`;

const kPlainFragment = `#version 300 es
precision highp float;
uniform vec4 ink;
out vec4 colour;
void main() { colour = vec4(ink.rgb * ink.a, ink.a); }`;

function compiled(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error('WebGL: ' + gl.getProgramInfoLog(program));
  }
  const uniforms = {};
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
    const {name} = gl.getActiveUniform(program, i);
    uniforms[name] = gl.getUniformLocation(program, name);
  }
  return {program, uniforms};
}

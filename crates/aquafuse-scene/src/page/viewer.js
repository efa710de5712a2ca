// Shows the splats of this page: one instanced quad a splat, far ones first. What is drawn is what `aquafuse scene render`
// draws, but for harmonics: a splat has one colour here, seen through the water at its own distance.
"use strict";

const scene = JSON.parse(document.getElementById("scene").textContent);
const canvas = document.querySelector("canvas");
const gl = canvas.getContext("webgl2", { antialias: false, alpha: false, preserveDrawingBuffer: true });

const VERTEX = `#version 300 es
precision highp float;
precision highp usampler2D;
uniform usampler2D splats;          // three texels a splat, 512 splats a row
uniform mat3 turn;                  // from the scene's axes to the camera's: x right, y down, z ahead
uniform vec3 shift;
uniform vec2 focal, centre, size;   // pixels
uniform float amount;               // how much of the water is there, 0 to 1
uniform vec3 veil, growth, held;
uniform vec4 fading[3];             // two exponentials of the distance a channel
in vec2 corner;
in uint number;
out vec2 place;
out vec4 paint;

void main() {
  ivec2 at = ivec2(int(number & 511u) * 3, int(number >> 9u));
  uvec4 first = texelFetch(splats, at, 0), second = texelFetch(splats, at + ivec2(1, 0), 0);
  uvec4 third = texelFetch(splats, at + ivec2(2, 0), 0);
  vec3 seen = turn * uintBitsToFloat(first.xyz) + shift;
  vec4 colour = vec4(third.z & 65535u, third.z >> 16u, third.w & 65535u, third.w >> 16u)
    / vec4(8192.0, 8192.0, 8192.0, 65535.0);
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
  if (seen.z < 0.05) return;

  vec4 upper = uintBitsToFloat(second);
  vec2 lower = uintBitsToFloat(third.xy);
  mat3 spread = mat3(upper.xyz, upper.y, upper.w, lower.x, upper.z, lower);
  // Flattened where it is; beyond the margin of the image, where that would blow it up, at the margin.
  vec2 low = -centre / focal, high = (size - centre) / focal, margin = 0.3 * 0.5 * size / focal;
  vec2 slant = clamp(seen.xy / seen.z, low - margin, high + margin);
  mat2x3 press = mat2x3(vec3(1.0, 0.0, -slant.x) * focal.x / seen.z, vec3(0.0, 1.0, -slant.y) * focal.y / seen.z);
  mat2x3 axes = transpose(turn) * press;
  mat2 ellipse = transpose(axes) * spread * axes;
  float xx = ellipse[0][0] + 0.3, xy = ellipse[0][1], yy = ellipse[1][1] + 0.3;
  // On a larger area it is fainter, so that it hides as much.
  colour.a *= sqrt(max(determinant(ellipse) / (xx * yy - xy * xy), 2.5e-5));
  float square = 2.0 * log(max(colour.a, 1e-9) * 255.0);
  if (square <= 0.0) return;
  float middle = 0.5 * (xx + yy), apart = length(vec2(0.5 * (xx - yy), xy));
  float large = middle + apart, small = max(middle - apart, 0.05);
  vec2 way = xx > yy ? vec2(large - yy, xy) : vec2(xy, large - xx);
  vec2 along = apart < 1e-6 ? vec2(1.0, 0.0) : way / length(way);
  place = corner * sqrt(square);
  vec2 pixel = focal * seen.xy / seen.z + centre
    + place.x * sqrt(large) * along + place.y * sqrt(small) * vec2(-along.y, along.x);
  gl_Position = vec4(2.0 * pixel.x / size.x - 1.0, 1.0 - 2.0 * pixel.y / size.y, 0.0, 1.0);

  float away = length(seen);
  vec3 z = min(vec3(away), held);
  vec3 beta;
  for (int c = 0; c < 3; c++) beta[c] = fading[c].x * exp(fading[c].y * z[c]) + fading[c].z * exp(fading[c].w * z[c]);
  vec3 water = veil * (1.0 - exp(-amount * growth * away));
  paint = vec4(colour.rgb * exp(-amount * beta * away) + water, colour.a);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec2 place;
in vec4 paint;
out vec4 result;
void main() {
  float alpha = min(0.99, paint.a * exp(-0.5 * dot(place, place)));
  if (alpha < 1.0 / 255.0) discard;
  result = vec4(paint.rgb * alpha, alpha);
}`;

// The splats, 36 bytes each: three floats of place, three deviations, words of colour and opacity, bytes of a quaternion.
const packed = Uint8Array.from(atob(document.getElementById("splats").textContent), (c) => c.charCodeAt(0));
const count = packed.length / 36;
const places = new Float32Array(3 * count);

function texels() {
  const rows = Math.max(1, Math.ceil(count / 512));
  const words = new Uint32Array(12 * 512 * rows);
  const floats = new Float32Array(words.buffer);
  const view = new DataView(packed.buffer);
  for (let i = 0; i < count; i++) {
    const from = 36 * i, to = 12 * i;
    for (let a = 0; a < 3; a++) floats[to + a] = places[3 * i + a] = view.getFloat32(from + 4 * a, true);
    for (const word of [0, 1]) words[to + 10 + word] = view.getUint32(from + 24 + 4 * word, true);
    const scale = [0, 1, 2].map((a) => view.getFloat32(from + 12 + 4 * a, true));
    const q = [0, 1, 2, 3].map((a) => view.getInt8(from + 32 + a));
    const length = Math.hypot(...q) || 1;
    const [w, x, y, z] = q.map((v) => v / length);
    const axes = [
      [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
      [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
      [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ];
    const spread = (a, b) => [0, 1, 2].reduce((sum, k) => sum + axes[a][k] * axes[b][k] * scale[k] ** 2, 0);
    floats.set([spread(0, 0), spread(0, 1), spread(0, 2), spread(1, 1), spread(1, 2), spread(2, 2)], to + 4);
  }
  return [words, rows];
}

function program() {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  gl.useProgram(made);
  return made;
}

let uniform;
const order = { buffer: null, numbers: new Uint32Array(count) };

function prepare() {
  const made = program();
  uniform = (name) => gl.getUniformLocation(made, name);
  const [words, rows] = texels();
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32UI, 3 * 512, rows, 0, gl.RGBA_INTEGER, gl.UNSIGNED_INT, words);
  const attribute = (name) => gl.getAttribLocation(made, name);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), gl.STATIC_DRAW);
  gl.enableVertexAttribArray(attribute("corner"));
  gl.vertexAttribPointer(attribute("corner"), 2, gl.FLOAT, false, 0, 0);
  order.buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, order.buffer);
  gl.enableVertexAttribArray(attribute("number"));
  gl.vertexAttribIPointer(attribute("number"), 1, gl.UNSIGNED_INT, 0, 0);
  gl.vertexAttribDivisor(attribute("number"), 1);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
}

// Far ones first, by counting 65,536 steps of depth.
function sort([, , ahead], shift) {
  const depths = new Float32Array(count);
  let near = Infinity, far = -Infinity;
  for (let i = 0; i < count; i++) {
    const depth = ahead[0] * places[3 * i] + ahead[1] * places[3 * i + 1] + ahead[2] * places[3 * i + 2] + shift[2];
    depths[i] = depth;
    near = Math.min(near, depth);
    far = Math.max(far, depth);
  }
  const scale = 65535 / Math.max(far - near, 1e-9);
  const starts = new Uint32Array(65537);
  const step = (i) => Math.floor((far - depths[i]) * scale);
  for (let i = 0; i < count; i++) starts[step(i) + 1]++;
  for (let s = 0; s < 65536; s++) starts[s + 1] += starts[s];
  for (let i = 0; i < count; i++) order.numbers[starts[step(i)]++] = i;
  gl.bindBuffer(gl.ARRAY_BUFFER, order.buffer);
  gl.bufferData(gl.ARRAY_BUFFER, order.numbers, gl.DYNAMIC_DRAW);
}

const water = scene.water ?? { veil: [0, 0, 0], growth: [0, 0, 0], fading: [0, 1, 2].map(() => [0, 0, 0, 0]), held: [0, 0, 0] };

// Draws the scene from a camera, as large as it fits into the window, with so much of the water.
function draw(camera, amount) {
  const pixels = window.devicePixelRatio || 1;
  const width = (canvas.width = Math.max(1, Math.round(canvas.clientWidth * pixels)));
  const height = (canvas.height = Math.max(1, Math.round(canvas.clientHeight * pixels)));
  const scale = Math.min(width / camera.width, height / camera.height);
  const shift = camera.turn.map((row) => -dot(row, camera.position));
  sort(camera.turn, shift);
  gl.viewport(0, 0, width, height);
  // Open water begins where hardly anything is seen, and goes with the water.
  const open = 8 / Math.max(Math.min(...water.growth), 1e-6);
  gl.clearColor(...water.veil.map((v, c) => v * (1 - Math.exp(-amount * water.growth[c] * open))), 1);
  gl.clear(gl.COLOR_BUFFER_BIT);
  gl.uniformMatrix3fv(uniform("turn"), true, camera.turn.flat());
  gl.uniform3fv(uniform("shift"), shift);
  gl.uniform2f(uniform("focal"), scale * camera.focal[0], scale * camera.focal[1]);
  gl.uniform2f(
    uniform("centre"),
    0.5 * width + scale * (camera.centre[0] - 0.5 * camera.width),
    0.5 * height + scale * (camera.centre[1] - 0.5 * camera.height),
  );
  gl.uniform2f(uniform("size"), width, height);
  gl.uniform1f(uniform("amount"), amount);
  gl.uniform3fv(uniform("veil"), water.veil);
  gl.uniform3fv(uniform("growth"), water.growth);
  gl.uniform3fv(uniform("held"), water.held);
  gl.uniform4fv(uniform("fading"), water.fading.flat());
  gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
}

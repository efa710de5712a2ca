// Who looks from where: the pointer, keys, the bar below, and an orbit that runs by itself.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, b, by = 1) => a.map((v, i) => v + by * b[i]);
const unit = (a) => a.map((v) => v / (Math.hypot(...a) || 1));

// A vector turned about an axis (Rodrigues).
function turned(v, axis, angle) {
  const [sin, cos] = [Math.sin(angle), Math.cos(angle)];
  return plus(plus(v.map((x) => x * cos), cross(axis, v), sin), axis, dot(axis, v) * (1 - cos));
}

const state = { view: 0, camera: null, target: null, amount: 1, orbits: false, asked: false };
const element = (id) => document.getElementById(id);

function ask() {
  if (state.asked) return;
  state.asked = true;
  requestAnimationFrame((time) => {
    state.asked = false;
    if (state.orbits) sway(time);
    draw(state.camera, state.amount);
    if (state.orbits) ask();
  });
}

// Goes to a camera of the scene; what it turns about is the point ahead of it that is as far as the scene's middle.
function go(view) {
  state.view = (view + scene.cameras.length) % scene.cameras.length;
  const { turn, shift, ...camera } = scene.cameras[state.view];
  const position = [0, 1, 2].map((i) => -turn.reduce((sum, row, r) => sum + row[i] * shift[r], 0));
  state.camera = { ...camera, turn, position };
  const away = Math.max(dot(turn[2], plus(scene.middle, position, -1)), 1e-3);
  state.target = plus(position, turn[2], away);
  element("view").textContent = `${state.view + 1} / ${scene.cameras.length}`;
  element("name").textContent = camera.name;
  ask();
}

// Turns the camera about the target: to the side about what is up, then over about its own right.
function turn(side, over) {
  const { camera, target } = state;
  const steepness = (rows) => Math.abs(dot(rows[2], scene.up));
  for (const [axis, angle] of [[scene.up, side], [camera.turn[0], over]]) {
    const rows = camera.turn.map((row) => turned(row, axis, angle));
    // Never over the top.
    if (axis !== scene.up && steepness(rows) > Math.max(0.985, steepness(camera.turn))) continue;
    camera.turn = rows;
    camera.position = plus(target, turned(plus(camera.position, target, -1), axis, angle));
  }
}

function nearer(factor) {
  state.camera.position = plus(state.target, plus(state.camera.position, state.target, -1), factor);
}

function move(x, y) {
  const { camera } = state;
  const away = Math.hypot(...plus(camera.position, state.target, -1));
  const scale = away / (camera.focal[0] * Math.min(canvas.clientWidth / camera.width, canvas.clientHeight / camera.height));
  const by = plus(camera.turn[0].map((v) => -v * x * scale), camera.turn[1], -y * scale);
  camera.position = plus(camera.position, by);
  state.target = plus(state.target, by);
}

// Two seconds to a side, some ten degrees: all that is behind was perhaps never seen.
let before = null;
function sway(time) {
  const angle = (t) => 0.18 * Math.sin(t / 1300);
  if (before !== null) turn(angle(time) - angle(before), 0.25 * (angle(time + 900) - angle(before + 900)));
  before = time;
}

function orbit(on) {
  state.orbits = on;
  before = null;
  element("orbit").setAttribute("aria-pressed", on);
  ask();
}

function listen() {
  const pointers = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    orbit(false);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const spread = () => Math.hypot(...[...pointers.values()].reduce((a, b) => [a[0] - b[0], a[1] - b[1]]));
    const [x, y] = [event.clientX - last[0], event.clientY - last[1]];
    const apart = spread();
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (pointers.size > 1) {
      nearer(apart / Math.max(spread(), 1));
      move(0.5 * x, 0.5 * y);
    } else if (event.buttons & 2 || event.shiftKey) {
      move(x, y);
    } else {
      turn(-x * 0.006, -y * 0.006);
    }
    ask();
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    nearer(Math.exp(0.001 * event.deltaY));
    ask();
  }, { passive: false });
  window.addEventListener("keydown", (event) => {
    if (event.target.tagName === "INPUT" && event.key.startsWith("Arrow")) return;
    const steps = { ArrowLeft: () => go(state.view - 1), ArrowRight: () => go(state.view + 1), o: () => orbit(!state.orbits) };
    steps[event.key]?.();
  });
  window.addEventListener("resize", ask);
  element("back").addEventListener("click", () => go(state.view - 1));
  element("on").addEventListener("click", () => go(state.view + 1));
  element("orbit").addEventListener("click", () => orbit(!state.orbits));
  element("water").addEventListener("input", (event) => {
    state.amount = Number(event.target.value);
    ask();
  });
}

// #view=3&water=0 opens the page there; #bare=1 without the bar.
const asked = new URLSearchParams(location.hash.slice(1));
document.body.classList.toggle("bare", asked.has("bare"));
element("splatted").textContent = `${count.toLocaleString("en")} splats`;
element("wet").hidden = !scene.water;
state.amount = scene.water ? Number(asked.get("water") ?? 1) : 0;
element("water").value = state.amount;
if (gl) {
  prepare();
  listen();
  go(Number(asked.get("view") ?? 1) - 1);
} else {
  element("trouble").hidden = false;
}

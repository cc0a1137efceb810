"use strict";
// Solids of tets: turned, cut by a plane, coloured by quality. WebGL2 draws them; without it a plain canvas does.
(() => {
  const RAMP = [[178, 24, 43], [239, 138, 98], [250, 225, 205], [103, 169, 207], [33, 102, 172]];
  const INVERTED = [255, 221, 0];
  const PLAIN = [120, 158, 205];
  const INVERTED_CODE = 255;
  const LEVELS = 254;
  // Corners of the faces of a positively oriented tet, each opposite one vertex and wound outwards.
  const FACES = [1, 2, 3, 0, 3, 2, 0, 1, 3, 0, 2, 1];
  const DISTANCE = 4; // of the eye from the middle, in half diagonals of the solid
  const START = { yaw: 35, pitch: 20, zoom: 1 };

  const element = (name) => document.getElementById(`viewer-${name}`);
  const canvas = element("canvas");
  const sets = JSON.parse(element("solids").textContent);
  const state = { set: 0, sample: 0, ...START };

  // Reading -----------------------------------------------------------------------------------------------

  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

  /** Corner coordinates of every tet, 12 numbers each, moved to the middle and scaled to a ball of radius 1. */
  function unpack(solid) {
    const codes = new Uint16Array(bytes(solid.positions).buffer);
    const raw = bytes(solid.tets).buffer;
    const tets = solid.wide ? new Uint32Array(raw) : new Uint16Array(raw);
    const most = [0, 0, 0];
    codes.forEach((code, place) => { most[place % 3] = Math.max(most[place % 3], code); });
    const half = Math.hypot(...most) / 2 || 1;
    const corners = new Float32Array(3 * tets.length);
    tets.forEach((vertex, place) => {
      for (let axis = 0; axis < 3; axis += 1) {
        corners[3 * place + axis] = (codes[3 * vertex + axis] - most[axis] / 2) / half;
      }
    });
    const centres = new Float32Array(3 * solid.count);
    for (let place = 0; place < centres.length; place += 1) {
      const start = 12 * Math.floor(place / 3) + (place % 3);
      centres[place] = (corners[start] + corners[start + 3] + corners[start + 6] + corners[start + 9]) / 4;
    }
    return { tets, corners, centres, dihedral: bytes(solid.dihedral), ratio: bytes(solid.ratio), about: solid };
  }

  // View --------------------------------------------------------------------------------------------------

  /** Rows right, up and back of the eye's axes; y is up, and a yaw of 0 looks from the front, +z. */
  function turned({ yaw, pitch }) {
    const [a, e] = [(yaw * Math.PI) / 180, (pitch * Math.PI) / 180];
    const [sa, ca, se, ce] = [Math.sin(a), Math.cos(a), Math.sin(e), Math.cos(e)];
    return [[ca, 0, -sa], [-sa * se, ce, -ca * se], [sa * ce, se, ca * ce]];
  }

  const dot = (normal, values, start) =>
    normal[0] * values[start] + normal[1] * values[start + 1] + normal[2] * values[start + 2];

  /** The cutting plane: what has normal . x > offset goes. */
  function plane(solid, axes) {
    const normal = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1], view: axes[2] }[element("axis").value];
    let [low, high] = [Infinity, -Infinity];
    for (let start = 0; start < solid.centres.length; start += 3) {
      const along = dot(normal, solid.centres, start);
      low = Math.min(low, along);
      high = Math.max(high, along);
    }
    const slack = 1e-5; // all of it stays at 0 and goes at 1, whatever the rounding
    return { normal, offset: high + slack - Number(element("cut").value) * (high - low + 2 * slack) };
  }

  const isKept = (solid, cut, tet) => dot(cut.normal, solid.centres, 3 * tet) <= cut.offset;

  function colourOf(code) {
    if (code === INVERTED_CODE) return INVERTED;
    const along = (code / LEVELS) * (RAMP.length - 1);
    const step = Math.min(Math.floor(along), RAMP.length - 2);
    return RAMP[step].map((value, channel) => value + (along - step) * (RAMP[step + 1][channel] - value));
  }

  // Drawing with WebGL2: each tet is one instance of twelve vertices --------------------------------------

  const VERTEX = `#version 300 es
    layout(location = 0) in vec3 a;
    layout(location = 1) in vec3 b;
    layout(location = 2) in vec3 c;
    layout(location = 3) in vec3 d;
    layout(location = 4) in float code;
    uniform mat3 axes;
    uniform vec4 plane;
    uniform vec2 scale;
    out vec3 seen;
    out vec3 corner;
    flat out float level;
    const int FACES[12] = int[12](${FACES});
    void main() {
      vec3 corners[4] = vec3[4](a, b, c, d);
      vec3 centre = (a + b + c + d) / 4.0;
      seen = axes * corners[FACES[gl_VertexID]];
      int side = gl_VertexID % 3;
      corner = vec3(side == 0, side == 1, side == 2);
      level = code;
      float ahead = ${DISTANCE.toFixed(1)} - seen.z;
      float near = ${(DISTANCE - 1.1).toFixed(1)}, far = ${(DISTANCE + 1.1).toFixed(1)};
      float depth = ((far + near) * ahead - 2.0 * far * near) / (far - near);
      bool gone = dot(plane.xyz, centre) > plane.w;
      gl_Position = gone ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(seen.xy * scale, depth, ahead);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 seen;
    in vec3 corner;
    flat in float level;
    uniform vec3 ramp[${RAMP.length}];
    uniform vec3 inverted;
    uniform vec3 plain;
    uniform bool coloured;
    out vec4 colour;
    void main() {
      float along = level / ${LEVELS.toFixed(1)} * ${(RAMP.length - 1).toFixed(1)};
      int part = int(min(along, ${(RAMP.length - 2).toFixed(1)}));
      vec3 base = level > ${LEVELS.toFixed(1)} ? inverted : mix(ramp[part], ramp[part + 1], along - float(part));
      if (!coloured) base = plain;
      vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
      float light = 0.6 + 0.35 * abs(normal.z) + 0.1 * normal.y;
      float inside = min(min(corner.x, corner.y), corner.z);
      float width = fwidth(inside);
      float edge = (1.0 - smoothstep(0.0, 1.4 * width, inside)) * (1.0 - smoothstep(0.08, 0.3, width));
      colour = vec4(base * light * (1.0 - 0.65 * edge), 1.0);
    }`;

  function withWebgl() {
    const gl = canvas.getContext("webgl2", { antialias: true });
    if (!gl) return null;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    gl.enable(gl.DEPTH_TEST);
    const place = (name) => gl.getUniformLocation(program, name);
    gl.uniform3fv(place("ramp"), RAMP.flat().map((value) => value / 255));
    gl.uniform3fv(place("inverted"), INVERTED.map((value) => value / 255));
    gl.uniform3fv(place("plain"), PLAIN.map((value) => value / 255));
    const corners = gl.createBuffer();
    const codes = gl.createBuffer();
    let loaded = null;

    function load(solid) {
      if (loaded === solid) return;
      loaded = solid;
      gl.bindBuffer(gl.ARRAY_BUFFER, corners);
      gl.bufferData(gl.ARRAY_BUFFER, solid.corners, gl.STATIC_DRAW);
      for (let slot = 0; slot < 4; slot += 1) {
        gl.enableVertexAttribArray(slot);
        gl.vertexAttribPointer(slot, 3, gl.FLOAT, false, 48, 12 * slot);
        gl.vertexAttribDivisor(slot, 1);
      }
    }

    return function draw(solid, axes, cut, kind) {
      load(solid);
      gl.bindBuffer(gl.ARRAY_BUFFER, codes);
      gl.bufferData(gl.ARRAY_BUFFER, solid[kind] || solid.ratio, gl.DYNAMIC_DRAW);
      gl.enableVertexAttribArray(4);
      gl.vertexAttribPointer(4, 1, gl.UNSIGNED_BYTE, false, 1, 0);
      gl.vertexAttribDivisor(4, 1);
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      const scale = focal();
      gl.uniform2f(place("scale"), (scale * 2) / canvas.width, (scale * 2) / canvas.height);
      gl.uniformMatrix3fv(place("axes"), true, axes.flat());
      gl.uniform4f(place("plane"), ...cut.normal, cut.offset);
      gl.uniform1i(place("coloured"), kind !== "plain");
      gl.drawArraysInstanced(gl.TRIANGLES, 0, FACES.length, solid.about.count);
    };
  }

  /** Pixels a unit at distance 1 from the eye. */
  const focal = () => 0.48 * Math.min(canvas.width, canvas.height) * (DISTANCE - 0.2) * state.zoom;

  // Drawing without it: the faces that bound what is kept, the furthest first ------------------------------

  /** For each face of each tet the tet across it, or -1. */
  function twins(solid) {
    const across = new Int32Array(solid.tets.length).fill(-1);
    const open = new Map();
    const many = solid.about.vertices;
    for (let face = 0; face < across.length; face += 1) {
      const tet = face >> 2;
      const [i, j, k] = [0, 1, 2]
        .map((side) => solid.tets[4 * tet + FACES[3 * (face & 3) + side]])
        .sort((one, other) => one - other);
      const key = (i * many + j) * many + k;
      if (open.has(key)) {
        const other = open.get(key);
        across[face] = other >> 2;
        across[other] = tet;
      } else open.set(key, face);
    }
    return across;
  }

  function withCanvas() {
    const context = canvas.getContext("2d");
    return function draw(solid, axes, cut, kind) {
      solid.across = solid.across || twins(solid);
      const scale = focal();
      const shown = [];
      for (let face = 0; face < solid.across.length; face += 1) {
        const tet = face >> 2;
        const other = solid.across[face];
        if (isKept(solid, cut, tet) && (other < 0 || !isKept(solid, cut, other))) {
          const points = [0, 1, 2].map((side) => {
            const start = 12 * tet + 3 * FACES[3 * (face & 3) + side];
            return axes.map((axis) => dot(axis, solid.corners, start));
          });
          shown.push({ points, tet, near: points[0][2] + points[1][2] + points[2][2] });
        }
      }
      context.clearRect(0, 0, canvas.width, canvas.height);
      context.lineWidth = 0.6;
      context.lineJoin = "round";
      for (const { points, tet } of shown.sort((one, other) => one.near - other.near)) {
        const base = kind === "plain" ? PLAIN : colourOf(solid[kind][tet]);
        const light = shade(points);
        context.fillStyle = `rgb(${base.map((value) => Math.round(Math.min(255, value * light)))})`;
        context.strokeStyle = `rgb(${base.map((value) => Math.round(value * light * 0.4))})`;
        context.beginPath();
        for (const [x, y, z] of points) {
          const size = scale / (DISTANCE - z);
          context.lineTo(canvas.width / 2 + x * size, canvas.height / 2 - y * size);
        }
        context.closePath();
        context.fill();
        context.stroke();
      }
    };
  }

  function shade([p, q, r]) {
    const [u, v] = [q.map((value, axis) => value - p[axis]), r.map((value, axis) => value - p[axis])];
    const cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const size = Math.hypot(...cross) || 1;
    const facing = cross[2] < 0 ? -1 : 1;
    return 0.6 + 0.35 * Math.abs(cross[2] / size) + (0.1 * facing * cross[1]) / size;
  }

  // The page around it ------------------------------------------------------------------------------------

  const solids = new Map(); // unpacked when first shown
  const painter = withWebgl();
  const draw = painter || withCanvas();
  canvas.dataset.renderer = painter ? "webgl2" : "2d";

  function current() {
    const packed = sets[state.set].solids[state.sample];
    if (!solids.has(packed)) solids.set(packed, unpack(packed));
    return solids.get(packed);
  }

  /** As many pixels as the screen has; setting a size clears the canvas even if it is the same. */
  function fit() {
    const pixels = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(1, Math.round(side * pixels)));
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
  }

  function refresh() {
    fit();
    const solid = current();
    const axes = turned(state);
    const cut = plane(solid, axes);
    const kind = element("colour").value;
    draw(solid, axes, cut, kind);
    let kept = 0;
    for (let tet = 0; tet < solid.about.count; tet += 1) kept += isKept(solid, cut, tet);
    canvas.dataset.shown = kept;
    say(solid.about, kept);
    legend(solid, kind);
  }

  function say({ id, count, inverted, smallest }, kept) {
    const angle = smallest === null ? "" : `, smallest dihedral angle of the others ${smallest}°`;
    const slow = painter ? "" : " This browser has no WebGL2: a plain canvas draws, slower and less exactly.";
    element("status").textContent =
      `Sample ${id}: ${count} tets, ${inverted} inverted${angle}; ${kept} shown.${slow}`;
  }

  function legend(solid, kind) {
    element("legend").hidden = kind === "plain";
    if (kind === "plain") return;
    const angles = kind === "dihedral";
    element("legend-title").textContent = angles ? "smallest dihedral angle" : "radius ratio";
    element("most").textContent = angles ? `${element("legend").dataset.regular}° (regular)` : "1 (regular)";
    element("ramp").style.background = `linear-gradient(to right, ${RAMP.map((colour) => `rgb(${colour})`)})`;
    element("inverted").style.background = `rgb(${INVERTED})`;
    histogram(solid[kind]);
  }

  function histogram(codes) {
    const bars = new Array(64).fill(0);
    for (const code of codes) if (code <= LEVELS) bars[Math.min(63, code >> 2)] += 1;
    const most = Math.max(...bars) || 1;
    const into = element("histogram");
    const context = into.getContext("2d");
    context.clearRect(0, 0, into.width, into.height);
    context.fillStyle = getComputedStyle(element("legend")).color;
    bars.forEach((bar, place) => {
      const height = (into.height * bar) / most;
      context.fillRect(place * 4, into.height - height, 3, height);
    });
  }

  let waiting = false;
  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      refresh();
    });
  }

  function listSamples() {
    const buttons = sets[state.set].solids.map(({ id }, number) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = id;
      button.setAttribute("aria-pressed", String(number === state.sample));
      button.addEventListener("click", () => {
        state.sample = number;
        listSamples();
        redraw();
      });
      return button;
    });
    element("samples").replaceChildren(...buttons);
  }

  function turn(right, up) {
    state.yaw = (state.yaw - right) % 360;
    state.pitch = Math.max(-89, Math.min(89, state.pitch + up));
    redraw();
  }

  function zoom(factor) {
    state.zoom = Math.max(0.3, Math.min(8, state.zoom * factor));
    redraw();
  }

  element("set").addEventListener("change", () => {
    Object.assign(state, { set: Number(element("set").value), sample: 0 });
    listSamples();
    redraw();
  });
  for (const name of ["colour", "axis"]) element(name).addEventListener("change", redraw);
  element("cut").addEventListener("input", redraw);
  element("reset").addEventListener("click", () => {
    Object.assign(state, START);
    redraw();
  });
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons & 1) turn(event.movementX / 2, event.movementY / 2);
  });
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas) return; // the page scrolls on until the viewer was clicked
    event.preventDefault();
    zoom(Math.exp(-event.deltaY / 600));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, -5], ArrowDown: [0, 5] };
    if (steps[event.key]) turn(...steps[event.key]);
    else if (event.key === "+" || event.key === "-") zoom(event.key === "+" ? 1.15 : 1 / 1.15);
    else return;
    event.preventDefault();
  });
  new ResizeObserver(redraw).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);

  listSamples();
  redraw();
})();

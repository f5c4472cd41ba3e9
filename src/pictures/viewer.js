/* The liquid through time, to turn and play: THREE and its OrbitControls are in the page before this. One unit of
   length of the scene is data.size. */
'use strict';
(function () {
  const data = JSON.parse(document.getElementById('states').textContent);
  const [view, slider, label, button, choice, scale] =
    ['view', 'moment', 'time', 'play', 'color', 'scale'].map(id => document.getElementById(id));
  const FRAME = 150; // ms between times, in the mean: each as long as the liquid takes for it
  const NEAR = 0.01, FAR = 100; // of the camera; the scene has the size 1
  const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(data.angle, 1 / data.ratio, NEAR, FAR);
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
  } catch (error) {
    view.textContent = 'This browser has no WebGL, so the liquid cannot be turned here; the pictures below show it.';
    document.querySelectorAll('.turn').forEach(part => { part.hidden = true; });
    return;
  }
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  const CORNERS = 8; // of a disc
  const unit = place => place.map((x, d) => (x - data.focus[d]) / data.size);
  let playing = null, drawn = [];

  function numbers(text, Type) {
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
    return new Type(bytes.buffer);
  }

  /* Coordinates of a shape in units of the scene; they are stored as 16-bit steps. */
  function places(shape) {
    const steps = numbers(shape.points, Uint16Array), points = new Float32Array(steps.length);
    for (let k = 0; k < steps.length; k++) {
      points[k] = (data.lower[k % 3] + steps[k] * data.step[k % 3] - data.focus[k % 3]) / data.size;
    }
    return points;
  }

  /* A mesh, or discs as polygons; colors: three bytes a point. */
  function geometry(shape, colors) {
    const result = new THREE.BufferGeometry();
    let points = places(shape), cells;
    if ('cells' in shape) {
      cells = numbers(shape.cells, shape.wide ? Uint32Array : Uint16Array);
    } else {
      const centers = points, radii = numbers(shape.radii, Uint8Array), n = radii.length;
      const shades = colors && new Uint8Array(3 * CORNERS * n);
      points = new Float32Array(3 * CORNERS * n);
      cells = new Uint32Array(3 * (CORNERS - 2) * n);
      for (let k = 0, c = 0; k < n; k++) {
        for (let j = 0; j < CORNERS; j++) {
          const at = 3 * (CORNERS * k + j), turn = 2 * Math.PI * j / CORNERS;
          const radius = radii[k] / 255 * shape.largest / data.size;
          points.set([centers[3 * k] + radius * Math.cos(turn), centers[3 * k + 1] + radius * Math.sin(turn), 0], at);
          if (colors) shades.set(colors.subarray(3 * k, 3 * k + 3), at);
          if (j > 1) cells.set([CORNERS * k, CORNERS * k + j - 1, CORNERS * k + j], 3 * c++);
        }
      }
      colors = shades;
    }
    result.setAttribute('position', new THREE.BufferAttribute(points, 3));
    result.setIndex(new THREE.BufferAttribute(cells, 1));
    if (colors) result.setAttribute('color', new THREE.BufferAttribute(colors, 3, true));
    if ('normals' in shape) {
      result.setAttribute('normal', new THREE.BufferAttribute(numbers(shape.normals, Int8Array), 3, true));
    } else if (!data.flat) result.computeVertexNormals();
    return result;
  }

  /* Bytes of the colours of a time: the bodies', or the scale's. */
  function colorsOf(state) {
    const coloring = data.colorings.find(item => item.name === choice.value);
    if (!coloring) return state.colors && numbers(state.colors, Uint8Array);
    const map = numbers(coloring.map, Uint8Array), values = numbers(state.values[coloring.name], Uint8Array);
    const colors = new Uint8Array(3 * values.length);
    values.forEach((value, k) => colors.set(map.subarray(3 * value, 3 * value + 3), 3 * k));
    return colors;
  }

  function material(style) {
    if (data.flat) return new THREE.MeshBasicMaterial({side: THREE.DoubleSide, ...style});
    return new THREE.MeshPhongMaterial({side: THREE.DoubleSide, shininess: 60, specular: 0x222222, ...style});
  }

  function faint(shape, opacity, color = data.solidColor) {
    const style = {color: color, transparent: true, opacity: opacity, depthWrite: false};
    return new THREE.Mesh(geometry(shape), material(style));
  }

  /* Pockets of gas show through the liquid that encloses them. */
  function pockets(shape) {
    const mesh = faint(shape, 0.35, data.gasColor);
    mesh.material.depthTest = false;
    mesh.renderOrder = 1;
    return mesh;
  }

  function draw() {
    renderer.render(scene, camera);
  }

  function show(number) {
    const state = data.states[number], colors = colorsOf(state);
    drawn.forEach(mesh => {
      scene.remove(mesh);
      mesh.geometry.dispose();
      mesh.material.dispose();
    });
    const style = colors ? {vertexColors: THREE.VertexColors} : {color: data.bodies[0].color};
    drawn = [new THREE.Mesh(geometry(state, colors), material(style)), faint(data.solids[state.solid], 0.5)];
    if ('gas' in state) drawn.push(pockets(state.gas));
    drawn.forEach(mesh => scene.add(mesh));
    label.textContent = state.text;
    slider.value = number;
    draw();
    document.body.dataset.triangles = drawn[0].geometry.index.count / 3;
  }

  /* The legend of the bodies, or the scale with its numbers. */
  function legend() {
    const coloring = data.colorings.find(item => item.name === choice.value);
    scale.innerHTML = '';
    if (!coloring) {
      for (const body of data.bodies.length > 1 ? data.bodies : []) {
        const mark = document.createElement('span');
        mark.textContent = body.name;
        mark.style.borderLeft = '1em solid ' + body.color;
        scale.appendChild(mark);
      }
      return;
    }
    const map = numbers(coloring.map, Uint8Array), strip = document.createElement('div');
    const stops = [0, 32, 64, 96, 128, 160, 192, 224, 255].map(k => `rgb(${map.subarray(3 * k, 3 * k + 3).join()})`);
    strip.style.background = `linear-gradient(to right, ${stops.join()})`;
    strip.className = 'strip';
    scale.appendChild(strip);
    coloring.ticks.forEach((value, k, all) => {
      const tick = document.createElement('span');
      tick.textContent = k === all.length - 1 ? `${value} ${coloring.unit}` : value;
      scale.appendChild(tick);
    });
  }

  function resize() {
    const width = view.clientWidth;
    renderer.setPixelRatio(window.devicePixelRatio || 1);
    renderer.setSize(width, Math.round(width * data.ratio));
    draw();
  }

  function play() {
    const last = data.states.length - 1, speed = FRAME * last / (data.states[last].time - data.states[0].time);
    const next = () => {
      const now = +slider.value, wait = now < last ? speed * (data.states[now + 1].time - data.states[now].time) : FRAME;
      playing = setTimeout(() => { show(now < last ? now + 1 : 0); next(); }, wait);
    };
    if (playing) {
      clearTimeout(playing);
      playing = null;
    } else {
      next();
    }
    button.textContent = playing ? 'Pause' : 'Play';
  }

  view.appendChild(renderer.domElement);
  scene.background = new THREE.Color(0xffffff);
  scene.add(new THREE.HemisphereLight(0xffffff, 0xa0b0c0, 0.95));
  const light = new THREE.DirectionalLight(0xffffff, 0.5);
  light.position.set(0.5, -1, 1.5);
  scene.add(light, faint(data.walls, data.flat ? 0.8 : 0.1));
  if (data.box) {
    const corners = data.box.map(corner => new THREE.Vector3(...unit(corner)));
    scene.add(new THREE.Box3Helper(new THREE.Box3(...corners), 0xbbbbbb));
  }
  if (data.flat) {
    controls.enableRotate = false;
    controls.mouseButtons.LEFT = THREE.MOUSE.PAN;
    controls.touches.ONE = THREE.TOUCH.PAN;
  } else {
    camera.up.set(0, 0, 1);
  }
  camera.position.set(...unit(data.eye));
  controls.addEventListener('change', draw);
  controls.update();
  for (const name of ['body', ...data.colorings.map(item => item.name)]) {
    const coloring = data.colorings.find(item => item.name === name);
    choice.add(new Option(coloring ? coloring.title : data.bodies.length > 1 ? 'liquid' : 'one colour', name));
  }
  choice.addEventListener('change', () => {
    legend();
    show(+slider.value);
  });
  slider.max = data.states.length - 1;
  slider.addEventListener('input', () => show(+slider.value));
  button.addEventListener('click', play);
  document.addEventListener('moment', event => { // a time in s, from the curves
    const away = data.states.map(state => Math.abs(state.time - event.detail));
    show(away.indexOf(Math.min(...away)));
  });
  window.addEventListener('resize', resize);
  legend();
  show(Math.floor(data.states.length / 3));
  resize();
})();

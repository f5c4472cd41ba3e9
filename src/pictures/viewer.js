/* The liquid's surface through time, to turn and play: THREE and its OrbitControls are in the page before this. */
'use strict';
(function () {
  const data = JSON.parse(document.getElementById('surfaces').textContent);
  const view = document.getElementById('view'), slider = document.getElementById('moment');
  const label = document.getElementById('time'), button = document.getElementById('play');
  const FRAME = 120; // ms between times
  const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(35, 2, 0.01, 100);
  const renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  let playing = null, mesh = null;

  function numbers(text, Type) {
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
    return new Type(bytes.buffer);
  }

  /* One time: coordinates are 16-bit steps of the box, colours bytes, triangles 16- or 32-bit indices. */
  function surface(state) {
    const geometry = new THREE.BufferGeometry(), places = numbers(state.points, Uint16Array);
    const points = new Float32Array(places.length);
    for (let k = 0; k < places.length; k++) points[k] = data.lower[k % 3] + places[k] * data.step[k % 3];
    geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(numbers(state.colors, Uint8Array), 3, true));
    geometry.setIndex(new THREE.BufferAttribute(numbers(state.cells, state.wide ? Uint32Array : Uint16Array), 1));
    geometry.computeVertexNormals();
    return geometry;
  }

  function draw() {
    renderer.render(scene, camera);
  }

  function show(number) {
    const state = data.states[number];
    if (mesh) {
      scene.remove(mesh);
      mesh.geometry.dispose();
    }
    mesh = new THREE.Mesh(surface(state), new THREE.MeshPhongMaterial(
      {vertexColors: THREE.VertexColors, side: THREE.DoubleSide, shininess: 60, specular: 0x333333}));
    scene.add(mesh);
    label.textContent = state.time;
    slider.value = number;
    draw();
    document.body.dataset.triangles = mesh.geometry.index.count / 3;
  }

  function resize() {
    const width = view.clientWidth, height = Math.round(width * 0.55);
    renderer.setPixelRatio(window.devicePixelRatio || 1);
    renderer.setSize(width, height);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    draw();
  }

  function box() {
    const lower = new THREE.Vector3(...data.box[0]), upper = new THREE.Vector3(...data.box[1]);
    scene.add(new THREE.Box3Helper(new THREE.Box3(lower, upper), 0x999999));
  }

  view.appendChild(renderer.domElement);
  scene.background = new THREE.Color(0xffffff);
  scene.add(new THREE.HemisphereLight(0xffffff, 0xa0b0c0, 0.95));
  const light = new THREE.DirectionalLight(0xffffff, 0.6);
  light.position.set(0.5, -1, 1.5);
  scene.add(light);
  box();
  camera.up.set(0, 0, 1);
  camera.position.set(...data.eye);
  controls.target.set(...data.focus);
  controls.addEventListener('change', draw);
  controls.update();
  slider.max = data.states.length - 1;
  slider.addEventListener('input', () => show(+slider.value));
  button.addEventListener('click', () => {
    if (playing) {
      clearInterval(playing);
      playing = null;
    } else {
      playing = setInterval(() => show((+slider.value + 1) % data.states.length), FRAME);
    }
    button.textContent = playing ? 'Pause' : 'Play';
  });
  window.addEventListener('resize', resize);
  show(Math.floor(data.states.length / 3));
  resize();
})();

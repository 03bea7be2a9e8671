// Draws the arm in three dimensions. It draws only on request. It calls `on_change` when the reader
// has moved the camera.
import {
  Box3,
  BufferGeometry,
  Color,
  DirectionalLight,
  Group,
  HemisphereLight,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  Scene,
  Sphere,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { make } from '../app/dom';
import { calc_frames, find_position, type Frame } from './chain';
import { find_colour, type Rgb } from './colours';
import { make_bodies, to_matrix } from './geometry';
import type { Track } from './scenario';
import { find_trace_parts, kGhost, type Setting, type Snapshot, type Stage, type ViewChoice } from './stage';
import { make_ground, make_target, Points, release } from './surroundings';
import { Trace } from './trace';

const kDirections: Record<ViewChoice, [number, number, number]> = {
  perspective: [1, -1.35, 0.62],
  side: [0, -1, 0.02], // the arm points to the right, as in Fig. 6.2 of the thesis
  front: [1, 0, 0.02],
  top: [0, -0.002, 1], // the arm points to the right
};

const kMovingShare = 0.7; // share of the pixels in each direction while the processor draws a moving picture
const kSharpAfter_ms = 250;

const kFilling = 0.8; // share of the picture that the ball around the arm and its points fills

// Returns whether the processor draws. Then edges are not smoothed, because that takes a third of
// the time.
function is_drawn_by_processor(): boolean {
  const context = document.createElement('canvas').getContext('webgl2');
  const names = context?.getExtension('WEBGL_debug_renderer_info') ?? null;
  if (context === null || names === null) {
    return false;
  }
  const name = String(context.getParameter(names.UNMASKED_RENDERER_WEBGL));
  context.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

class Arm {
  readonly group = new Group();
  private readonly bodies: Mesh[];
  private readonly paints: MeshLambertMaterial[]; // one per body

  constructor(
    geometries: BufferGeometry[],
    private readonly material: MeshLambertMaterial,
  ) {
    this.bodies = geometries.map((geometry) => {
      const body = new Mesh(geometry, material);
      body.matrixAutoUpdate = false;
      this.group.add(body);
      return body;
    });
    this.paints = geometries.map(() => new MeshLambertMaterial());
  }

  // `paints` has the colour of each body after the base. null: the colours of the robot.
  show(frames: Frame[], paints: string[] | null): void {
    this.bodies.forEach((body, i) => {
      body.material = paints === null || i === 0 ? this.material : this.paints[i];
      if (paints !== null && i > 0) {
        this.paints[i].color.set(paints[i - 1]);
      }
      to_matrix(frames[i], body.matrix);
      body.matrixWorldNeedsUpdate = true;
    });
  }

  dispose(): void {
    [this.material, ...this.paints].forEach((material) => material.dispose());
    this.group.removeFromParent();
  }
}

// Returns the box around the base, the places of the test case and the start of the arm.
function find_extent(setting: Setting): Box3 {
  const { chain, places_m, replay } = setting.scenario;
  const box = new Box3().expandByPoint(new Vector3(0, 0, 0));
  for (const point of places_m) {
    box.expandByPoint(new Vector3(...point));
  }
  for (const frame of calc_frames(chain, replay.start_q)) {
    box.expandByPoint(new Vector3(...find_position(frame)));
  }
  return box.expandByScalar(0.2);
}

export class Stage3d implements Stage {
  readonly element: HTMLElement;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(32, 1, 0.05, 60);
  private readonly controls: OrbitControls;
  private readonly label = make('span', { class: 'replay-point' });
  private readonly canvas = make('canvas', { tabindex: '0', role: 'img' });
  private readonly restored = () => this.on_change();
  private readonly by_processor: boolean;
  private size = { width: 1, height: 1 };
  private pixel_ratio = 1;
  private sharpening = 0; // number of the timer
  private setting: Setting | null = null;
  private extent = new Sphere(new Vector3(0, 0, 1), 1.5);
  private view: ViewChoice = 'perspective';
  private still: { ground: Group; points: Points; target: Mesh } | null = null;
  private geometries: { robot: unknown; bodies: BufferGeometry[] } = { robot: null, bodies: [] };
  private arm: Arm | null = null;
  private ghost: Arm | null = null;
  private traces: { main: Trace | null; ghost: Trace | null } = { main: null, ghost: null };

  // Throws if WebGL is not available.
  constructor(private readonly on_change: () => void) {
    this.by_processor = is_drawn_by_processor();
    const options = { antialias: !this.by_processor, alpha: false, preserveDrawingBuffer: true };
    const context = this.canvas.getContext('webgl2', options) as WebGL2RenderingContext | null;
    if (context === null) {
      throw new Error('no WebGL 2');
    }
    this.renderer = new WebGLRenderer({ canvas: this.canvas, context, ...options });
    this.element = make('div', { class: 'replay-stage' }, this.canvas, this.label);
    this.camera.up.set(0, 0, 1);
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(1.5, -3, 4);
    this.scene.add(new HemisphereLight(0xffffff, 0x9aa4b0, 1.6), sun);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.maxPolarAngle = Math.PI * 0.55;
    this.controls.minDistance = 0.3;
    this.controls.maxDistance = 20;
    this.controls.addEventListener('change', this.on_change);
    this.canvas.addEventListener('webglcontextrestored', this.restored);
  }

  set_setting(setting: Setting): void {
    const before = this.setting;
    this.setting = setting;
    const { scenario, look } = setting;
    if (before?.scenario !== scenario || before.look !== look) {
      this.set_surroundings(setting);
    }
    if (before?.scenario !== scenario) {
      find_extent(setting).getBoundingSphere(this.extent);
      this.set_view(this.view);
    }
    this.set_arms(setting);
    this.set_traces(setting);
    this.canvas.setAttribute('aria-label', `The arm ${scenario.chain.robot.name}, ${scenario.replay.label}`);
  }

  show(snapshot: Snapshot): void {
    const setting = this.setting;
    if (setting === null || this.still === null) {
      return;
    }
    const { chain, replay } = setting.scenario;
    this.arm?.show(calc_frames(chain, snapshot.q), snapshot.paints);
    if (this.ghost !== null && snapshot.ghost_q !== null) {
      this.ghost.show(calc_frames(chain, snapshot.ghost_q), null);
    }
    this.still.target.visible = snapshot.target_m !== null;
    if (snapshot.target_m !== null) {
      this.still.target.position.set(...snapshot.target_m);
    }
    this.still.points.show(snapshot.segment + 1);
    for (const [track, trace] of [
      [setting.track, this.traces.main],
      [setting.ghost, this.traces.ghost],
    ] as const) {
      if (track !== null) {
        trace?.show(find_trace_parts(setting, track.count, snapshot));
      }
    }
    this.render();
    this.place_label(replay.points_m[snapshot.segment + 1], snapshot.segment + 1);
  }

  // A moving picture may be coarse if the processor must draw every pixel. A picture at rest is
  // sharp.
  private render(): void {
    if (this.by_processor) {
      clearTimeout(this.sharpening);
      this.sharpening = window.setTimeout(() => {
        this.set_pixel_ratio(this.pixel_ratio);
        this.renderer.render(this.scene, this.camera);
      }, kSharpAfter_ms);
      this.set_pixel_ratio(kMovingShare * this.pixel_ratio);
    }
    this.renderer.render(this.scene, this.camera);
  }

  private set_pixel_ratio(ratio: number): void {
    if (this.renderer.getPixelRatio() !== ratio) {
      this.renderer.setPixelRatio(ratio);
    }
  }

  set_view(view: ViewChoice): void {
    this.view = view;
    const { center, radius } = this.extent;
    const half = ((this.camera.fov / 2) * Math.PI) / 180;
    const narrow = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    const direction = new Vector3(...kDirections[view]).normalize();
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(direction, (kFilling * radius) / Math.sin(narrow));
    this.controls.update();
    this.on_change();
  }

  resize(width: number, height: number, pixel_ratio: number): void {
    const first = this.size.width === 1;
    this.size = { width, height };
    this.pixel_ratio = pixel_ratio;
    this.renderer.setPixelRatio(pixel_ratio);
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (first) {
      this.set_view(this.view);
    }
  }

  dispose(): void {
    clearTimeout(this.sharpening);
    this.controls.dispose();
    this.canvas.removeEventListener('webglcontextrestored', this.restored);
    this.clear_still();
    this.clear_moving();
    this.geometries.bodies.forEach((geometry) => geometry.dispose());
    this.renderer.dispose();
    this.renderer.forceContextLoss(); // browsers allow only few contexts at the same time
    this.element.remove();
  }

  private set_surroundings({ scenario, look }: Setting): void {
    this.clear_still();
    this.scene.background = new Color(look.background);
    const reach = Math.max(...scenario.places_m.map((point) => Math.hypot(point[0], point[1])), 1);
    this.still = { ground: make_ground(look, reach), points: new Points(scenario.replay.points_m, look), target: make_target(look) };
    this.scene.add(this.still.ground, this.still.points.group, this.still.target);
  }

  private set_arms({ scenario, ghost }: Setting): void {
    const { robot } = scenario.chain;
    this.arm?.dispose();
    this.ghost?.dispose();
    if (this.geometries.robot !== robot) {
      this.geometries.bodies.forEach((geometry) => geometry.dispose());
      this.geometries = { robot, bodies: make_bodies(robot) };
    }
    const { bodies } = this.geometries;
    this.arm = new Arm(bodies, new MeshLambertMaterial({ vertexColors: true }));
    // If both arms are in the same place, the solid one must be visible.
    const pale = { color: kGhost, transparent: true, opacity: 0.38, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 4 };
    this.ghost = ghost === null ? null : new Arm(bodies, new MeshLambertMaterial(pale));
    for (const arm of [this.arm, this.ghost]) {
      if (arm !== null) {
        this.scene.add(arm.group);
      }
    }
  }

  private set_traces({ scenario, track, ghost, scale, look }: Setting): void {
    this.clear_traces();
    const plain = (colour: string): Rgb => {
      const { r, g, b } = new Color(colour).getRGB({ r: 0, g: 0, b: 0 }, 'srgb');
      return [r, g, b];
    };
    const [accent, pale] = [plain(look.accent), plain(kGhost)];
    const paint = (of: Track, moment: number): Rgb => (scenario.is_recorded ? accent : find_colour(scale, of.errors_m[moment]));
    this.traces = {
      main: track === null ? null : new Trace(track.tip_m, (moment) => paint(track, moment), 3.5, look.background),
      ghost: ghost === null ? null : new Trace(ghost.tip_m, () => pale, 2, look.background),
    };
    for (const trace of [this.traces.main, this.traces.ghost]) {
      if (trace !== null) {
        this.scene.add(trace.group);
      }
    }
  }

  private place_label(point: [number, number, number] | undefined, number: number): void {
    this.label.hidden = point === undefined;
    if (point === undefined) {
      return;
    }
    const place = new Vector3(...point).project(this.camera);
    const x = ((place.x + 1) / 2) * this.size.width + 10;
    const y = ((1 - place.y) / 2) * this.size.height - 22;
    this.label.textContent = String(number);
    this.label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    this.label.hidden = Math.abs(place.x) > 1 || Math.abs(place.y) > 1 || place.z > 1;
  }

  private clear_still(): void {
    if (this.still !== null) {
      release(this.still.ground);
      release(this.still.points.group);
      release(this.still.target);
      this.still = null;
    }
  }

  private clear_traces(): void {
    for (const trace of [this.traces.main, this.traces.ghost]) {
      trace?.group.removeFromParent();
      trace?.dispose();
    }
  }

  private clear_moving(): void {
    this.arm?.dispose();
    this.ghost?.dispose();
    this.clear_traces();
  }
}

// The objects around the arm that do not move: the ground with its metres, and the path through the
// points of the test case.
import {
  BufferGeometry,
  CanvasTexture,
  Color,
  Float32BufferAttribute,
  Group,
  InstancedMesh,
  Line,
  LineBasicMaterial,
  LineSegments,
  Material,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  Object3D,
  SphereGeometry,
  Sprite,
  SpriteMaterial,
  Texture,
} from 'three';
import type { Look } from '../charts/look';

export const kCell_m = 0.5;

// Frees the memory on the graphics card of an object and its children.
export function release(root: Object3D): void {
  root.traverse((object) => {
    const holder = object as Partial<{ geometry: BufferGeometry; material: Material & { map?: Texture | null } }>;
    holder.geometry?.dispose();
    holder.material?.map?.dispose();
    holder.material?.dispose();
    if (object instanceof InstancedMesh) {
      object.dispose();
    }
  });
  root.removeFromParent();
}

function make_lines(positions: number[], colour: string): LineSegments {
  const geometry = new BufferGeometry().setAttribute('position', new Float32BufferAttribute(positions, 3));
  return new LineSegments(geometry, new LineBasicMaterial({ color: colour }));
}

function make_label(text: string, look: Look): Sprite {
  const canvas = document.createElement('canvas');
  canvas.width = 128;
  canvas.height = 64;
  const context = canvas.getContext('2d');
  if (context !== null) {
    context.font = `40px ${look.font}`;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillStyle = look.muted;
    context.fillText(text, 64, 32);
  }
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthWrite: false }));
  sprite.scale.set(0.3, 0.15, 1);
  return sprite;
}

// Returns squares of half a metre around the base, as far as the arm reaches. Lines at whole metres
// are stronger.
export function make_ground(look: Look, reach_m: number): Group {
  const group = new Group();
  const cells = Math.max(2, Math.ceil(reach_m / (2 * kCell_m)) * 2);
  const end = cells * kCell_m;
  const half: number[] = [];
  const whole: number[] = [];
  for (let i = -cells; i <= cells; ++i) {
    const place = i * kCell_m;
    (i % 2 === 0 ? whole : half).push(place, -end, 0, place, end, 0, -end, place, 0, end, place, 0);
  }
  const strong = new Color(look.grid).lerp(new Color(look.muted), 0.55);
  group.add(make_lines(half, look.grid), make_lines(whole, `#${strong.getHexString()}`));
  for (let metre = 1; metre <= end; ++metre) {
    const x = make_label(`${metre} m`, look);
    x.position.set(metre, -0.12, 0.02);
    group.add(x);
  }
  return group;
}

// The points of the trajectory. The point to which the target moves is emphasised.
export class Points {
  readonly group = new Group();
  private readonly dots: InstancedMesh;
  private shown = -1;

  constructor(
    private readonly points_m: [number, number, number][],
    private readonly look: Look,
  ) {
    const geometry = new BufferGeometry().setAttribute('position', new Float32BufferAttribute(points_m.flat(), 3));
    this.group.add(new Line(geometry, new LineBasicMaterial({ color: look.muted, transparent: true, opacity: 0.6 })));
    this.dots = new InstancedMesh(new SphereGeometry(0.013, 10, 6), new MeshBasicMaterial(), points_m.length);
    this.dots.frustumCulled = false;
    this.group.add(this.dots);
    this.show(0);
  }

  show(current: number): void {
    if (this.shown === current) {
      return;
    }
    this.shown = current;
    const matrix = new Matrix4();
    const reached = new Color(this.look.muted);
    const ahead = new Color(this.look.text);
    const here = new Color(this.look.bad);
    this.points_m.forEach((point, i) => {
      const size = i === current ? 2.1 : 1;
      matrix.makeScale(size, size, size).setPosition(...point);
      this.dots.setMatrixAt(i, matrix);
      this.dots.setColorAt(i, i === current ? here : i < current ? reached : ahead);
    });
    this.dots.instanceMatrix.needsUpdate = true;
    if (this.dots.instanceColor !== null) {
      this.dots.instanceColor.needsUpdate = true;
    }
  }
}

// The target is drawn through the arm, because most of the time it is inside the arm.
export function make_target(look: Look): Mesh {
  const material = new MeshBasicMaterial({ color: look.text, depthTest: false, transparent: true });
  const target = new Mesh(new SphereGeometry(0.02, 16, 10), material);
  target.renderOrder = 2;
  return target;
}

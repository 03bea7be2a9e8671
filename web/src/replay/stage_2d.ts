// Draws the arm from the side, the front or above, in lines, for browsers without WebGL.
import { make } from '../app/dom';
import { calc_frames, find_position, multiply } from './chain';
import { find_colour, to_css } from './colours';
import { find_trace_parts, kGhost, type Setting, type Snapshot, type Stage, type ViewChoice } from './stage';

type Point = [number, number, number];

export class Stage2d implements Stage {
  readonly element: HTMLElement;
  private readonly canvas = make('canvas', { role: 'img' });
  private setting: Setting | null = null;
  private size = { width: 1, height: 1, ratio: 1 };
  private view: ViewChoice = 'side';
  private place: (point: Point) => [number, number] = () => [0, 0];

  constructor(private readonly on_change: () => void) {
    const message = 'This browser has no 3D graphics (WebGL), so the arm is drawn in lines, from the side, the front or above.';
    this.element = make('div', { class: 'replay-stage' }, this.canvas, make('p', { class: 'replay-message' }, message));
  }

  set_setting(setting: Setting): void {
    this.setting = setting;
    const { chain, replay } = setting.scenario;
    this.canvas.setAttribute('aria-label', `The arm ${chain.robot.name} in lines, ${replay.label}`);
    this.fit();
  }

  show(snapshot: Snapshot): void {
    const context = this.canvas.getContext('2d');
    const setting = this.setting;
    if (context === null || setting === null) {
      return;
    }
    const { look, scenario, scale, track, ghost } = setting;
    context.setTransform(this.size.ratio, 0, 0, this.size.ratio, 0, 0);
    context.fillStyle = look.background;
    context.fillRect(0, 0, this.size.width, this.size.height);
    context.lineCap = context.lineJoin = 'round';
    if (this.view !== 'top') {
      this.draw_line(
        context,
        [
          [-9, -9, 0],
          [9, 9, 0],
        ],
        look.muted,
        1,
      );
    }
    this.draw_line(context, scenario.replay.points_m, look.grid, 1);
    scenario.replay.points_m.forEach((point, i) => {
      this.draw_dot(context, point, i === snapshot.segment + 1 ? look.bad : look.muted, i === snapshot.segment + 1 ? 5 : 3);
    });
    const main_colour = (k: number): string => (scenario.is_recorded ? look.accent : to_css(find_colour(scale, track?.errors_m[k] ?? 0)));
    for (const [one, colour] of [
      [ghost, () => kGhost],
      [track, main_colour],
    ] as const) {
      if (one === null) {
        continue;
      }
      const parts = find_trace_parts(setting, one.count, snapshot);
      context.globalAlpha = 0.35;
      this.draw_trace(context, one.tip_m, parts.past, colour);
      context.globalAlpha = 1;
      this.draw_trace(context, one.tip_m, parts.now, colour);
    }
    if (snapshot.ghost_q !== null) {
      this.draw_arm(context, snapshot.ghost_q, () => kGhost, 5);
    }
    this.draw_arm(context, snapshot.q, (body) => snapshot.paints?.[body - 1] ?? look.muted, 4);
    if (snapshot.target_m !== null) {
      this.draw_dot(context, snapshot.target_m, look.text, 6);
    }
  }

  set_view(view: ViewChoice): void {
    this.view = view;
    this.fit();
    this.on_change();
  }

  resize(width: number, height: number, ratio: number): void {
    this.size = { width, height, ratio };
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${height}px`;
    this.fit();
  }

  dispose(): void {
    this.element.remove();
  }

  private fit(): void {
    if (this.setting === null) {
      return;
    }
    const { chain, places_m, replay } = this.setting.scenario;
    const across = (point: Point): number => (this.view === 'front' ? point[1] : point[0]);
    const up = (point: Point): number => (this.view === 'top' ? point[1] : point[2]);
    const points: Point[] = [[0, 0, 0], ...places_m, ...calc_frames(chain, replay.start_q).map(find_position)];
    const x = points.map(across);
    const z = points.map(up);
    const [left, right] = [Math.min(...x) - 0.3, Math.max(...x) + 0.3];
    const [bottom, top] = [Math.min(...z) - 0.1, Math.max(...z) + 0.3];
    const { width, height } = this.size;
    const factor = Math.min(width / (right - left), height / (top - bottom));
    this.place = (point) => [
      width / 2 + (across(point) - (left + right) / 2) * factor,
      height / 2 - (up(point) - (bottom + top) / 2) * factor,
    ];
  }

  private draw_line(context: CanvasRenderingContext2D, points: Point[], colour: string, width: number): void {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    points.forEach((point) => context.lineTo(...this.place(point)));
    context.stroke();
  }

  private draw_dot(context: CanvasRenderingContext2D, point: Point, colour: string, radius: number): void {
    context.fillStyle = colour;
    context.beginPath();
    context.arc(...this.place(point), radius, 0, 2 * Math.PI);
    context.fill();
  }

  private draw_trace(context: CanvasRenderingContext2D, tip_m: Float32Array, part: [number, number], colour: (k: number) => string): void {
    const get = (k: number): Point => [tip_m[3 * k], tip_m[3 * k + 1], tip_m[3 * k + 2]];
    for (let k = part[0]; k < part[1]; ++k) {
      this.draw_line(context, [get(k), get(k + 1)], colour(k + 1), 2);
    }
  }

  // `colour` gives the colour of each body; the base has the index 0.
  private draw_arm(context: CanvasRenderingContext2D, q: number[], colour: (body: number) => string, width: number): void {
    if (this.setting === null) {
      return;
    }
    const { chain } = this.setting.scenario;
    const frames = calc_frames(chain, q);
    const points = frames.map(find_position);
    points.push(find_position(multiply(frames[frames.length - 1], chain.tip)));
    points.slice(1).forEach((point, body) => this.draw_line(context, [points[body], point], colour(body), width));
    points.forEach((point, i) => this.draw_dot(context, point, colour(Math.min(i, frames.length - 1)), width));
  }
}

// The error over the time of the whole test case, under the slider, which has the same time axis. It
// shows where something happens, and a click goes to that time.
import { make } from '../app/dom';
import type { Look } from '../charts/look';
import { format_number } from '../numbers';
import { find_colour, find_share, list_decades, to_css, type ColourScale } from './colours';
import type { Scenario, Track } from './scenario';
import { kGhost } from './stage';
import { clamp } from './timeline';

const kLeft = 62; // px; replay.css places the slider between the same ends
const kRight = 12;
const kTop = 6;
const kBottom = 20;
const kHeight = 132;

export class Strip {
  readonly element: HTMLElement;
  private readonly canvas = make('canvas', { role: 'img' });
  private readonly cursor = make('div', { class: 'replay-cursor' });
  private readonly pointer = make('div', { class: 'replay-pointer', hidden: '' });
  private width = 0;
  private moments = 1;

  // `on_point` gets the moment under a mouse, which may have a fraction, or null when it has left.
  constructor(
    private readonly on_seek: (moment: number) => void,
    on_point: (moment: number | null) => void,
  ) {
    this.element = make('div', { class: 'replay-strip' }, this.canvas, this.cursor, this.pointer);
    this.canvas.addEventListener('pointerdown', (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      this.seek(event);
    });
    this.canvas.addEventListener('pointermove', (event) => {
      if (event.buttons !== 0) {
        this.seek(event);
      }
      if (event.pointerType === 'mouse') {
        on_point(this.find_moment(event));
      }
    });
    this.canvas.addEventListener('pointerleave', () => on_point(null));
  }

  set_cursor(moment: number): void {
    this.cursor.style.transform = `translateX(${this.find_x(moment).toFixed(1)}px)`;
  }

  set_pointer(moment: number | null): void {
    this.pointer.hidden = moment === null;
    this.pointer.style.transform = `translateX(${this.find_x(moment ?? 0).toFixed(1)}px)`;
  }

  draw(width: number, scenario: Scenario, tracks: { main: Track | null; ghost: Track | null }, scale: ColourScale, look: Look): void {
    this.width = width;
    this.moments = Math.max(1, scenario.moments);
    const ratio = Math.min(2, window.devicePixelRatio);
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(kHeight * ratio);
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${kHeight}px`;
    this.canvas.setAttribute('aria-label', `Momentary error over time, ${scenario.replay.label}`);
    const context = this.canvas.getContext('2d');
    if (context === null || width <= kLeft + kRight) {
      return;
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = look.background;
    context.fillRect(0, 0, width, kHeight);
    this.draw_segments(context, scenario, look);
    this.draw_axes(context, scenario, scale, look);
    if (tracks.ghost !== null) {
      this.draw_errors(context, tracks.ghost, scale, () => kGhost, 1.25);
      this.draw_end(context, tracks.ghost, kGhost);
    }
    if (tracks.main !== null) {
      this.draw_errors(context, tracks.main, scale, (error) => to_css(find_colour(scale, error)), 1.75);
      this.draw_end(context, tracks.main, look.bad);
    }
  }

  private seek(event: PointerEvent): void {
    this.on_seek(Math.round(this.find_moment(event)));
  }

  private find_moment(event: PointerEvent): number {
    const share = (event.offsetX - kLeft) / Math.max(1, this.width - kLeft - kRight);
    return clamp(share, 0, 1) * this.moments;
  }

  private find_x(moment: number): number {
    return kLeft + (moment / this.moments) * Math.max(0, this.width - kLeft - kRight);
  }

  private find_y(scale: ColourScale, error_m: number): number {
    return kHeight - kBottom - find_share(scale, error_m) * (kHeight - kTop - kBottom);
  }

  // Shades the times at which errors are measured. A line shows where the move to the next point
  // begins.
  private draw_segments(context: CanvasRenderingContext2D, scenario: Scenario, look: Look): void {
    for (const segment of scenario.replay.segments) {
      const begin = this.find_x(segment.first_step);
      const end = this.find_x(segment.first_step + segment.steps);
      const window_begin = this.find_x(segment.first_step + segment.window_start);
      context.fillStyle = look.accent;
      context.globalAlpha = 0.14;
      context.fillRect(window_begin, kTop, Math.max(0, end - window_begin), kHeight - kTop - kBottom);
      context.globalAlpha = 1;
      context.fillStyle = look.grid;
      context.fillRect(begin, kTop, 1, kHeight - kTop - kBottom);
    }
  }

  private draw_axes(context: CanvasRenderingContext2D, scenario: Scenario, scale: ColourScale, look: Look): void {
    context.font = `11px ${look.font}`;
    context.fillStyle = look.muted;
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    const decades = list_decades(scale);
    decades.forEach((decade, i) => {
      const y = this.find_y(scale, decade);
      context.fillStyle = look.grid;
      context.fillRect(kLeft, y, this.width - kLeft - kRight, 1);
      context.fillStyle = look.muted;
      const text = format_number(1000 * decade, 1) + (i === decades.length - 1 ? ' mm' : '');
      context.fillText(text, kLeft - 6, clamp(y, kTop + 5, kHeight - kBottom - 3));
    });
    context.textBaseline = 'alphabetic';
    context.textAlign = 'center';
    const end_s = scenario.moments * scenario.period_s;
    const spacing = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find((step) => (end_s / step) * 60 < this.width) ?? end_s;
    for (let time = 0; time <= end_s * 1.0001; time += spacing) {
      const text = `${format_number(time, spacing < 1 ? 2 : Math.max(1, Math.floor(Math.log10(time || 1)) + 1))} s`;
      const x = this.find_x(time / scenario.period_s);
      context.fillText(text, Math.min(x, this.width - 14), kHeight - 6);
    }
  }

  // If many moments share a pixel, draws the smallest and the largest of their errors.
  private draw_errors(
    context: CanvasRenderingContext2D,
    track: Track,
    scale: ColourScale,
    colour: (error_m: number) => string,
    width: number,
  ): void {
    context.lineWidth = width;
    context.lineJoin = 'round';
    let from: [number, number] | null = null;
    for (let k = 0; k <= track.count;) {
      const column = Math.floor(this.find_x(k));
      let least = Infinity;
      let most = -Infinity;
      let last = 0;
      for (; k <= track.count && Math.floor(this.find_x(k)) === column; ++k) {
        last = track.errors_m[k];
        least = Math.min(least, last);
        most = Math.max(most, last);
      }
      context.strokeStyle = colour(most);
      context.beginPath();
      context.moveTo(...(from ?? [column + 0.5, this.find_y(scale, least)]));
      context.lineTo(column + 0.5, this.find_y(scale, most));
      context.lineTo(column + 0.5, this.find_y(scale, least));
      context.lineTo(column + 0.5, this.find_y(scale, last));
      context.stroke();
      from = [column + 0.5, this.find_y(scale, last)];
    }
  }

  private draw_end(context: CanvasRenderingContext2D, track: Track, colour: string): void {
    if (track.count < this.moments) {
      const x = this.find_x(track.count);
      context.strokeStyle = colour;
      context.lineWidth = 2;
      context.beginPath();
      context.moveTo(x - 5, kTop);
      context.lineTo(x + 5, kTop + 10);
      context.moveTo(x + 5, kTop);
      context.lineTo(x - 5, kTop + 10);
      context.stroke();
    }
  }
}

// The replay: an arm that follows the target of a test case, with its error over time, and a second
// design beside it if wanted. It draws only after a change.
import { make, make_button } from '../app/dom';
import type { Look } from '../charts/look';
import type { ReplayCase, ReplaySet, Robot } from '../data';
import { make_colour_scale, type ColourScale } from './colours';
import { find_colour_of, find_shares, type Paint } from './load';
import { Panel } from './panel';
import { Picker } from './picker';
import { find_q, find_target, make_scenario, type Scenario, type Track } from './scenario';
import type { Stage, TraceChoice, ViewChoice } from './stage';
import { Stage2d } from './stage_2d';
import { Stage3d } from './stage_3d';
import { Strip } from './strip';
import { clamp, find_moment, find_next_point, find_previous_point, find_segment } from './timeline';

export interface ReplayState {
  set: string;
  case: string;
  design: string; // "" if the case has no motion
  ghost: string; // "" if there is no ghost
  time_s: number;
  step: number; // control periods since the start
  playing: boolean;
  frames: number; // drawn so far
  last_frame_ms: number; // duration of the last frame
  graphics: 'webgl' | 'lines';
}

export interface ReplayView {
  set_time(time_s: number): void; // within the case that is shown; does not call on_time
  choose(set: string, case_id: string): void; // does nothing if the set or case does not exist
  set_pointer(time_s: number | null): void; // marks a time that the reader points at; null: none
  set_look(look: Look): void;
  dispose(): void;
  readonly state: ReplayState;
}

export interface ReplayEvents {
  // Called when the reader, or playing, has changed the time or the case.
  on_time?(set: string, case_id: string, time_s: number): void;
  // Called when the reader points at a time, and with null when the pointer has left.
  on_point?(set: string, case_id: string, time_s: number | null): void;
}

const kSpeeds = ['0.1', '0.25', '0.5', '1', '2', '4'];
const kLongestFrame_s = 0.25; // a page that was in the background continues where it was
const kSlowFrame_ms = 30;
const kSlowFrames = 12; // after so many slow frames in a row the picture gets coarser

function make_stage(on_change: () => void): Stage {
  try {
    return new Stage3d(on_change);
  } catch {
    return new Stage2d(on_change);
  }
}

class Replay implements ReplayView {
  private readonly root = make('div', { class: 'replay-root' });
  private readonly stage: Stage;
  private readonly panel = new Panel();
  private readonly strip: Strip;
  private readonly set_picker = new Picker('Problem', (id) => this.pick_set(id));
  private readonly case_picker = new Picker('Test case', (id) => this.pick_case(id));
  private readonly design_picker = new Picker('Design', (id) => this.pick_designs(id, this.state.ghost));
  private readonly ghost_picker = new Picker('Ghost', (id) => this.pick_designs(this.state.design, id));
  private readonly speed_picker = new Picker('Speed', () => this.schedule());
  private readonly trace_picker = new Picker('Path', () => this.schedule());
  private readonly paint_picker = new Picker('Arm', () => this.apply());
  private readonly play_button = make_button('Play', () => this.set_playing(!this.state.playing), { class: 'replay-play' });
  private readonly point_buttons = [
    make_button('Previous point', () => this.go_to_point(-1)),
    make_button('Next point', () => this.go_to_point(1)),
  ];
  private readonly strip_hint = make(
    'span',
    {},
    'The strip below the slider shows the error over the whole test case. In shaded times the error is measured. Click into the strip to go to a time. ',
  );
  private readonly scrub = make('input', { type: 'range', min: '0', step: '1', 'aria-label': 'Time', class: 'replay-scrub' });
  private readonly observer = new ResizeObserver(() => this.resize());

  readonly state: ReplayState;
  private readonly robots: Robot[];
  private readonly sets: ReplaySet[];
  private readonly events: ReplayEvents;
  private look: Look;
  private scenario: Scenario | null = null;
  private track: Track | null = null;
  private ghost: Track | null = null;
  private scale: ColourScale;
  private request = 0; // number of the requested frame; 0 if none is requested
  private last_tick_ms = 0;
  private slow_frames = 0;
  private is_slow = false;
  private is_disposed = false;

  constructor(host: HTMLElement, robots: Robot[], sets: ReplaySet[], look: Look, events: ReplayEvents) {
    this.robots = robots;
    this.sets = sets;
    this.look = look;
    this.events = events;
    this.scale = make_colour_scale([], look.theme);
    this.stage = make_stage(() => this.schedule());
    this.strip = new Strip(
      (moment) => this.seek(moment),
      (moment) => this.point(moment),
    );
    this.state = {
      set: '',
      case: '',
      design: '',
      ghost: '',
      time_s: 0,
      step: 0,
      playing: false,
      frames: 0,
      last_frame_ms: 0,
      graphics: this.stage instanceof Stage3d ? 'webgl' : 'lines',
    };
    this.build();
    host.replaceChildren(this.root);
    this.observer.observe(this.stage.element);
    this.observer.observe(this.strip.element);
    const first = sets.find((set) => set.cases.length > 0);
    if (first !== undefined) {
      this.show_case(first, first.cases[0]);
    }
  }

  set_time(time_s: number): void {
    if (this.scenario === null || !isFinite(time_s)) {
      return;
    }
    const { period_s, moments } = this.scenario;
    this.state.time_s = clamp(time_s, 0, period_s * moments);
    this.state.step = find_moment(this.state.time_s, period_s, moments);
    this.schedule();
  }

  choose(set_id: string, case_id: string): void {
    const set = this.sets.find((one) => one.id === set_id);
    const replay = set?.cases.find((one) => one.id === case_id);
    if (set !== undefined && replay !== undefined && (set_id !== this.state.set || case_id !== this.state.case)) {
      this.show_case(set, replay);
    }
  }

  set_pointer(time_s: number | null): void {
    this.strip.set_pointer(time_s === null || this.scenario === null ? null : time_s / this.scenario.period_s);
  }

  set_look(look: Look): void {
    this.look = look;
    this.apply();
  }

  dispose(): void {
    this.is_disposed = true;
    this.observer.disconnect();
    cancelAnimationFrame(this.request);
    this.stage.dispose();
    this.root.remove();
  }

  private build(): void {
    this.speed_picker.set(
      kSpeeds.map((value) => ({ value, label: `${value} ×` })),
      '1',
    );
    const paints: { value: Paint; label: string }[] = [
      { value: 'robot', label: 'in its own colours' },
      { value: 'torque', label: 'coloured by torque' },
      { value: 'position', label: 'coloured by joint limits' },
    ];
    this.paint_picker.set(paints, 'robot');
    const view = (label: string, choice: ViewChoice): HTMLElement => make_button(label, () => this.stage.set_view(choice));
    this.scrub.addEventListener('input', () => this.seek(Number(this.scrub.value)));
    this.root.addEventListener('keydown', (event) => this.handle_key(event));
    this.root.append(
      make(
        'div',
        { class: 'replay-choices' },
        ...[this.set_picker, this.case_picker, this.design_picker, this.ghost_picker, this.paint_picker, this.trace_picker].map(
          (picker) => picker.element,
        ),
        make(
          'span',
          { class: 'replay-views', role: 'group', 'aria-label': 'View' },
          view('Perspective', 'perspective'),
          view('Side', 'side'),
          view('Front', 'front'),
          view('Top', 'top'),
        ),
      ),
      make(
        'div',
        { class: 'replay-main' },
        this.stage.element,
        make('div', { class: 'replay-transport' }, this.play_button, ...this.point_buttons, this.speed_picker.element),
        make('div', { class: 'replay-times' }, this.scrub, this.strip.element),
        this.panel.element,
      ),
      make(
        'p',
        { class: 'replay-hint' },
        this.strip_hint,
        'The space bar plays and pauses, the arrow keys step (ten steps with Shift), and Home and End go to the ends. ' +
          'Drag to turn the view, use the wheel to zoom and the right button to move the view.',
      ),
    );
  }

  private pick_set(id: string): void {
    const set = this.sets.find((one) => one.id === id);
    if (set !== undefined && set.cases.length > 0) {
      this.show_case(set, set.cases[0]);
      this.tell();
    }
  }

  private pick_case(id: string): void {
    this.choose(this.state.set, id);
    this.tell();
  }

  // A design cannot be its own ghost.
  private pick_designs(design: string, ghost: string): void {
    const before = this.state.design;
    this.state.design = design;
    this.state.ghost = ghost === design ? (before === design ? '' : before) : ghost;
    this.apply();
  }

  private show_case(set: ReplaySet, replay: ReplayCase): void {
    this.scenario = make_scenario(set, replay, this.robots[set.robot]);
    const ids = replay.motions.map((motion) => motion.design);
    const { state } = this;
    const is_new_set = state.set !== set.id;
    state.set = set.id;
    state.case = replay.id;
    if (is_new_set || !ids.includes(state.design)) {
      state.design = ids[0] ?? '';
      state.ghost = ids[1] ?? '';
    } else if (!ids.includes(state.ghost)) {
      state.ghost = '';
    }
    this.set_controls(this.scenario.is_recorded);
    this.scrub.max = String(this.scenario.moments);
    this.set_playing(false);
    this.set_time(0);
    this.set_picker.set(
      this.sets.filter((one) => one.cases.length > 0).map((one) => ({ value: one.id, label: one.title })),
      set.id,
    );
    this.case_picker.set(
      set.cases.map((one) => ({ value: one.id, label: one.label })),
      replay.id,
    );
    this.apply();
  }

  // Shows only the controls that the motion has: one that a robot recorded has no moves and no errors.
  private set_controls(is_recorded: boolean): void {
    const traces: { value: TraceChoice; label: string }[] = is_recorded
      ? [
          { value: 'past', label: 'until now' },
          { value: 'whole', label: 'of the whole motion' },
        ]
      : [
          { value: 'past', label: 'until now, with earlier moves faint' },
          { value: 'move', label: 'of this move' },
          { value: 'whole', label: 'of the whole motion' },
        ];
    const { value } = this.trace_picker;
    this.trace_picker.set(traces, traces.some((one) => one.value === value) ? value : 'past');
    for (const element of [...this.point_buttons, this.strip.element, this.strip_hint]) {
      element.hidden = is_recorded;
    }
    this.case_picker.rename(is_recorded ? 'Log' : 'Test case');
  }

  // Updates everything that does not change with the time.
  private apply(): void {
    const { scenario, state, look } = this;
    if (scenario === null) {
      return;
    }
    const find = (id: string): Track | null => scenario.tracks.find((track) => track.motion.design === id) ?? null;
    this.track = find(state.design);
    this.ghost = find(state.ghost);
    const names = scenario.tracks.map((track) => ({ value: track.motion.design, label: track.name }));
    this.design_picker.set(names, state.design);
    const others = names.filter((one) => one.value !== state.design);
    this.ghost_picker.set([{ value: '', label: 'none' }, ...others], state.ghost);
    this.scale = make_colour_scale(
      scenario.tracks.map((track) => track.errors_m),
      look.theme,
    );
    this.stage.set_setting({ scenario, track: this.track, ghost: this.ghost, scale: this.scale, look });
    this.panel.set({ scenario, track: this.track, ghost: this.ghost, paint: this.paint_picker.value as Paint }, this.scale, look);
    this.draw_strip();
    this.schedule();
  }

  private draw_strip(): void {
    if (this.scenario !== null) {
      this.strip.draw(this.strip.element.clientWidth, this.scenario, { main: this.track, ghost: this.ghost }, this.scale, this.look);
    }
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.stage.element;
    if (clientWidth > 0 && clientHeight > 0) {
      this.stage.resize(clientWidth, clientHeight, this.is_slow ? 1 : Math.min(2, window.devicePixelRatio));
    }
    this.draw_strip();
    this.schedule();
  }

  private tell(): void {
    this.events.on_time?.(this.state.set, this.state.case, this.state.time_s);
  }

  private point(moment: number | null): void {
    const time_s = moment === null || this.scenario === null ? null : moment * this.scenario.period_s;
    this.events.on_point?.(this.state.set, this.state.case, time_s);
  }

  private seek(moment: number): void {
    if (this.scenario !== null) {
      this.set_time(moment * this.scenario.period_s);
      this.tell();
    }
  }

  private go_to_point(direction: 1 | -1): void {
    if (this.scenario === null) {
      return;
    }
    const { replay, moments } = this.scenario;
    const { step } = this.state;
    this.seek(direction < 0 ? find_previous_point(replay.segments, step) : find_next_point(replay.segments, step, moments));
  }

  private set_playing(playing: boolean): void {
    if (playing && this.scenario !== null && this.state.step >= this.scenario.moments) {
      this.set_time(0);
    }
    this.state.playing = playing && this.scenario !== null;
    this.play_button.textContent = this.state.playing ? 'Pause' : 'Play';
    this.last_tick_ms = 0;
    this.slow_frames = 0;
    this.schedule();
  }

  private handle_key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    const is_button = target instanceof HTMLButtonElement;
    if (target instanceof HTMLSelectElement || event.ctrlKey || event.altKey || event.metaKey || this.scenario === null) {
      return;
    }
    const stride = event.shiftKey ? 10 : 1;
    const { moments } = this.scenario;
    switch (event.key) {
      case ' ':
        if (is_button) {
          return; // the space bar presses this element
        }
        this.set_playing(!this.state.playing);
        break;
      case 'ArrowLeft':
        this.seek(clamp(this.state.step - stride, 0, moments));
        break;
      case 'ArrowRight':
        this.seek(clamp(this.state.step + stride, 0, moments));
        break;
      case 'Home':
        this.seek(0);
        break;
      case 'End':
        this.seek(moments);
        break;
      default:
        return;
    }
    event.preventDefault();
  }

  private schedule(): void {
    if (this.request === 0 && !this.is_disposed) {
      this.request = requestAnimationFrame((now_ms) => this.tick(now_ms));
    }
  }

  private tick(now_ms: number): void {
    this.request = 0;
    if (this.state.playing && this.scenario !== null) {
      if (this.last_tick_ms > 0) {
        this.advance(now_ms - this.last_tick_ms);
      }
      this.last_tick_ms = now_ms;
      this.schedule();
    }
    this.draw();
  }

  private advance(passed_ms: number): void {
    if (this.scenario === null) {
      return;
    }
    const passed_s = Math.min(kLongestFrame_s, passed_ms / 1000);
    this.set_time(this.state.time_s + passed_s * Number(this.speed_picker.value));
    if (this.state.step >= this.scenario.moments) {
      this.set_playing(false);
    }
    this.tell();
    this.slow_frames = passed_ms > kSlowFrame_ms ? this.slow_frames + 1 : 0;
    if (this.slow_frames >= kSlowFrames && !this.is_slow) {
      this.is_slow = true;
      this.resize();
    }
  }

  private draw(): void {
    const { scenario, state, track, ghost } = this;
    if (scenario === null || this.root.clientWidth === 0) {
      return; // the replay is in a tab that is not open
    }
    const begin_ms = performance.now();
    const moment = state.time_s / scenario.period_s;
    const segment = find_segment(scenario.replay.segments, state.step);
    const q = track === null ? scenario.replay.start_q : find_q(scenario, track, moment);
    const paint = this.paint_picker.value as Paint;
    const shares = paint === 'robot' ? null : find_shares(scenario, track, state.step, q, paint);
    this.stage.show({
      moment: Math.max(moment, state.step),
      q,
      ghost_q: ghost === null ? null : find_q(scenario, ghost, moment),
      target_m: find_target(scenario, moment),
      segment,
      trace: this.trace_picker.value as TraceChoice,
      paints: shares === null ? null : shares.map((share) => find_colour_of(share, this.look, paint)),
    });
    this.strip.set_cursor(moment);
    this.panel.show(state.step, segment, q, shares);
    const text = String(state.step);
    if (this.scrub.value !== text) {
      this.scrub.value = text;
    }
    this.scrub.setAttribute(
      'aria-valuetext',
      scenario.is_recorded ? `${state.time_s.toFixed(2)} s` : `${state.time_s.toFixed(2)} s, point ${segment + 1}`,
    );
    state.frames += 1;
    state.last_frame_ms = performance.now() - begin_ms;
  }
}

export function make_replay(host: HTMLElement, robots: Robot[], sets: ReplaySet[], look: Look, events: ReplayEvents): ReplayView {
  return new Replay(host, robots, sets, look, events);
}

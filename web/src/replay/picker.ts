// A labelled list of choices. Its entries change with other choices.
import { make } from '../app/dom';

export interface Option {
  value: string;
  label: string;
}

export class Picker {
  readonly element: HTMLElement;
  private readonly select = make('select');
  private readonly label = make('span');

  constructor(label: string, on_change: (value: string) => void) {
    this.element = make('label', { class: 'choice' }, this.label, this.select);
    this.rename(label);
    this.select.addEventListener('change', () => on_change(this.select.value));
  }

  get value(): string {
    return this.select.value;
  }

  rename(label: string): void {
    this.label.textContent = label;
  }

  // A list with fewer than two choices is not shown.
  set(options: Option[], value: string): void {
    this.select.replaceChildren(...options.map((option) => make('option', { value: option.value }, option.label)));
    this.select.value = value;
    this.element.hidden = options.length < 2;
  }
}

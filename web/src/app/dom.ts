// Functions that build the document. Text always stays text; these functions cannot insert markup.
export type Child = Node | string | null;

export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    element.setAttribute(name, value);
  }
  for (const child of children) {
    if (child !== null) {
      element.append(child);
    }
  }
  return element;
}

export function make_button(label: string, on_click: () => void, attributes: Record<string, string> = {}): HTMLButtonElement {
  const button = make('button', { type: 'button', ...attributes }, label);
  button.addEventListener('click', on_click);
  return button;
}

export function make_select(
  options: { value: string; label: string }[],
  initial: string,
  on_change: (value: string) => void,
): HTMLSelectElement {
  const select = make('select');
  for (const option of options) {
    const element = make('option', { value: option.value }, option.label);
    element.selected = option.value === initial;
    select.append(element);
  }
  select.addEventListener('change', () => on_change(select.value));
  return select;
}

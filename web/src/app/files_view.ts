// The view of the files that a problem left: images, and links that save each file.
import { shorten } from '../charts/names';
import type { FilesItem } from '../model';
import type { WinnerFile } from '../data';
import { format_number } from '../numbers';
import { make } from './dom';
import type { View } from './view';

// A file that is no image is never opened as a document, only saved.
function make_address(file: WinnerFile): string {
  const type = file.type.startsWith('image/') ? file.type : 'application/octet-stream';
  return file.text === null ? `data:${type};base64,${file.base64}` : `data:text/csv;charset=utf-8,${encodeURIComponent(file.text)}`;
}

function describe_size(bytes: number): string {
  return bytes < 1000 ? `${bytes} bytes` : bytes < 1e6 ? `${format_number(bytes / 1000, 3)} kB` : `${format_number(bytes / 1e6, 3)} MB`;
}

function make_file(file: WinnerFile): HTMLElement {
  const address = make_address(file);
  const image = file.type.startsWith('image/') ? make('img', { src: address, alt: `The image ${file.name}` }) : null;
  const link = make('a', { href: address, download: file.name }, shorten(file.name, 40));
  return make('figure', {}, image, make('figcaption', {}, link, `, ${describe_size(file.bytes)}`));
}

export function make_files_view(item: FilesItem): View {
  const element = make(
    'section',
    { class: 'card full files', id: 'figure-' + item.id, 'data-figure': item.id },
    make('h3', {}, item.title),
    make('p', { class: 'caption' }, item.caption),
    make('div', { class: 'file-list' }, ...item.files.map(make_file)),
  );
  return { element, set_look() {}, update: () => false, settle() {}, dispose() {} };
}

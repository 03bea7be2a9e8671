// A page's Markdown to HTML: anchors as GitHub makes them, code in colours, links from files to pages of the site.
import hljs from 'highlight.js/lib/common';
import cmake from 'highlight.js/lib/languages/cmake';
import MarkdownIt from 'markdown-it';
import anchor from 'markdown-it-anchor';

hljs.registerLanguage('cmake', cmake);
const kLanguages = {
  sh: 'shell',
  toml: 'ini',
  python: 'python',
  pycon: 'python',
  cpp: 'cpp',
  c: 'c',
  json: 'json',
  cmake: 'cmake',
  xml: 'xml',
  yaml: 'yaml',
};

export function escape_html(text) {
  return text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;').replaceAll('"', '&quot;');
}

// As GitHub names a heading's anchor: lower case, blanks to hyphens, no other signs. Repeated ones get -1, -2, ... by the plugin.
export function make_slug(heading) {
  return heading
    .trim()
    .toLowerCase()
    .replaceAll(/[^\p{L}\p{N}\p{M} _-]/gu, '')
    .replaceAll(' ', '-');
}

// Shell: notes, strings and flags. A highlighter for bash would see its keywords in ours (--set, test).
export function colour_shell(text) {
  const pieces = /(^|\s)(#\s.*$)|('[^']*'|"(?:[^"\\]|\\.)*")|(^|\s)(--?[a-zA-Z][\w-]*)/gm;
  const span = (name, piece) => `<span class="${name}">${escape_html(piece)}</span>`;
  let html = '';
  let end = 0;
  for (const match of text.matchAll(pieces)) {
    const [all, before_note, note, string, before_flag, flag] = match;
    html += escape_html(text.slice(end, match.index) + (before_note ?? before_flag ?? ''));
    html += note ? span('hljs-comment', note) : string ? span('hljs-string', string) : span('flag', flag);
    end = match.index + all.length;
  }
  return html + escape_html(text.slice(end));
}

function colour(text, language) {
  if (language === 'shell') {
    return colour_shell(text);
  }
  return language ? hljs.highlight(text, { language, ignoreIllegals: true }).value : escape_html(text);
}

// A session: what is typed, and what comes of it. Lines of a command that go on (\ at the end) belong to it.
export function render_session(text) {
  let goes_on = false;
  const lines = text.split('\n').map((line) => {
    if (line.startsWith('$ ') || goes_on) {
      const typed = line.replace(/^[$>] /, '');
      const prompt = line.startsWith('$ ') ? '$ ' : '> ';
      goes_on = line.endsWith('\\');
      return `<span class="prompt" aria-hidden="true">${escape_html(prompt)}</span><span class="typed">${colour_shell(typed)}</span>`;
    }
    return line === '' ? '' : `<span class="printed">${escape_html(line)}</span>`;
  });
  return lines.join('\n');
}

// A block of code; what stands behind its language is a file's name or says how the block is tried (docs/contributing.md).
export function render_fence(info, text) {
  const [language = '', argument = ''] = info.trim().split(/\s+/);
  const file = argument.includes('.') && !argument.includes('=') ? argument : '';
  const body = language === 'console' ? render_session(text.replace(/\n$/, '')) : colour(text.replace(/\n$/, ''), kLanguages[language]);
  const title = file ? `<figcaption>${escape_html(file)}</figcaption>` : '';
  const copy = ['sh', 'console'].includes(language) || file ? '<button class="copy" type="button">Copy</button>' : '';
  return `<figure class="code ${escape_html(language)}">${title}${copy}<pre><code>${body}</code></pre></figure>\n`;
}

const kLongName = 20; // characters

// Lets a line break at the joints of a long name: after . : / _ = - and before a capital letter. Else the name of a test or
// a path takes the width of the other columns of its table.
export function render_name(text) {
  const pieces = text.length > kLongName ? text.split(/(?<=[.:/_=-])(?=\w)|(?<=[a-z])(?=[A-Z])/) : [text];
  return `<code>${pieces.map(escape_html).join('<wbr>')}</code>`;
}

// render(text, resolve): {html, headings: [{level, slug, text}], parts: [{slug, title, text}], links: [target]}.
// `resolve(target, is_image)` gives a link's address in the site.
export function make_renderer() {
  const markdown = new MarkdownIt({ html: true, linkify: false, typographer: false });
  markdown.renderer.rules.fence = (tokens, index) => render_fence(tokens[index].info, tokens[index].content);
  markdown.renderer.rules.code_inline = (tokens, index) => render_name(tokens[index].content);
  markdown.renderer.rules.code_block = (tokens, index) => {
    const text = tokens[index].content;
    return render_fence(/^armwright /.test(text) ? 'sh' : 'text', text);
  };
  // A heading without words, such as that of a column of notes, is no heading.
  markdown.renderer.rules.th_open = (tokens, index, options, env, self) => {
    const tag = tokens[index + 1].content === '' ? 'td' : 'th';
    tokens[index].tag = tag;
    tokens[index + 2].tag = tag;
    return self.renderToken(tokens, index, options);
  };
  markdown.renderer.rules.table_open = () => '<div class="table"><table>\n';
  markdown.renderer.rules.table_close = () => '</table></div>\n';
  markdown.use(anchor, {
    level: [1, 2, 3, 4],
    slugify: make_slug,
    tabIndex: false,
    // For the mouse: it shows where to copy the address of a part. The keyboard would stop at every heading.
    permalink: anchor.permalink.linkInsideHeader({
      symbol: '#',
      placement: 'after',
      class: 'anchor',
      ariaHidden: true,
      renderAttrs: () => ({ tabindex: '-1' }),
    }),
  });

  return (text, resolve) => {
    // What scripts say to authors in a comment is not for readers.
    const tokens = markdown.parse(text.replace(/^<!--.*?-->\n/s, ''), {});
    const headings = [];
    const parts = [{ slug: '', title: '', text: '' }];
    const links = [];
    for (const [index, token] of tokens.entries()) {
      if (token.type === 'heading_open') {
        const inline = tokens[index + 1];
        const title = inline.children
          .filter((child) => child.type === 'text' || child.type === 'code_inline')
          .map((child) => child.content)
          .join('')
          .trim();
        headings.push({ level: Number(token.tag.slice(1)), slug: token.attrGet('id'), text: title });
        parts.push({ slug: token.attrGet('id'), title, text: '' });
      } else if (token.type === 'inline' && tokens[index - 1].type !== 'heading_open') {
        parts.at(-1).text += `${token.children.map((child) => child.content).join(' ')} `;
      } else if (token.type === 'fence' || token.type === 'code_block') {
        parts.at(-1).text += `${token.content} `;
      }
      for (const child of token.children ?? []) {
        const attribute = child.type === 'image' ? 'src' : child.type === 'link_open' ? 'href' : '';
        const target = attribute && child.attrGet(attribute);
        if (target && child.attrGet('class') !== 'anchor') {
          links.push(target);
          child.attrSet(attribute, resolve(target, child.type === 'image'));
        }
      }
    }
    return { html: markdown.renderer.render(tokens, markdown.options, {}), headings, parts, links };
  };
}

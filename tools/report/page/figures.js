// SPDX-License-Identifier: BSD-3-Clause
// Draws the pictures of data, which answer: values under the pointer, the same point marked in all pictures of one file,
// zoom, a switch per curve, and the shown data as CSV.  Without script the page names the files that show them.
'use strict';
(() => {
  const left = 78, right = 16, top = 30, bottom = 54, reach = 40;
  const node = (name, attributes, parent, text) => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const key in attributes) made.setAttribute(key, attributes[key]);
    if (text !== undefined) made.textContent = text;
    if (parent) parent.append(made);
    return made;
  };
  const element = (name, parent, properties) => {
    const made = Object.assign(document.createElement(name), properties);
    parent.append(made);
    return made;
  };

  // The markup of labels: "^{a}" is raised, a backslash takes the meaning from what follows.
  function pieces(label) {
    const found = [];
    for (const [, raised, escaped, plain] of label.matchAll(/\^\{([^}]*)\}|\\(.)|([^\\^]+|\^)/gs)) {
      found.push({raised: raised !== undefined, text: raised ?? escaped ?? plain});
    }
    return found;
  }
  const plain = (label) => pieces(label).map((piece) => piece.text).join('');
  const write = (label, parent) =>
    pieces(label).forEach((piece) => element(piece.raised ? 'sup' : 'span', parent, {textContent: piece.text}));

  // Six significant digits, in the words of a tick or a value, from a size on as a power of ten.
  function number(value, large = 1e6) {
    const rounded = Number(value.toPrecision(6));
    const size = Math.abs(rounded);
    if (size === 0 || (size >= 1e-4 && size < large)) return String(rounded).replace('-', '−');
    const [mantissa, exponent] = rounded.toExponential().split('e');
    const raised = [...exponent].map((sign) => ({'+': '', '-': '⁻'})[sign] ?? '⁰¹²³⁴⁵⁶⁷⁸⁹'[sign]).join('');
    return (mantissa === '1' ? '' : mantissa.replace('-', '−') + '·') + '10' + raised;
  }

  // Axes
  const to = (axis, value) => (axis.logarithmic ? Math.log10(value) : value);
  const from = (axis, value) => (axis.logarithmic ? 10 ** value : value);
  // Ranges are kept as drawn: of logarithms where the axis is logarithmic.
  function fitted(panel, name) {
    let lowest = Infinity, highest = -Infinity;
    for (const point of panel.curves.flatMap((curve) => curve.points)) {
      const value = to(panel[name], point[name]);
      if (Number.isFinite(value)) [lowest, highest] = [Math.min(lowest, value), Math.max(highest, value)];
    }
    if (lowest > highest) [lowest, highest] = [0, 1];
    const pad = highest > lowest ? 0.04 * (highest - lowest) : 0.05 * Math.abs(highest) || 1;
    const end = panel[name].to;
    return [lowest - pad, end === undefined ? highest + pad : to(panel[name], end)];
  }
  function widened([a, b], length) {
    const middle = (a + b) / 2;
    return [middle - length / 2, middle + length / 2];
  }
  function set_range(panel, x, y) {
    if (panel.equal_axes) {
      const unit = Math.max((x[1] - x[0]) / panel.width, (y[1] - y[0]) / panel.height);
      [x, y] = [widened(x, unit * panel.width), widened(y, unit * panel.height)];
    }
    panel.range = {x, y};
  }
  function ticks(axis, [a, b]) {
    if (axis.logarithmic && b - a > 1) {
      const step = Math.ceil((b - a) / 8), values = [];
      const between = shows_decades(axis, [a, b]) ? [1] : [1, 2, 5];
      for (let e = Math.floor(a / step) * step; e <= b; e += step) {
        for (const mantissa of between) values.push(e + Math.log10(mantissa));
      }
      return values.filter((value) => value >= a && value <= b);
    }
    const low = from(axis, a), high = from(axis, b), rough = (high - low) / 6;
    const power = 10 ** Math.floor(Math.log10(rough));
    const angle = axis.degrees && high - low > 1 && [1, 2, 5, 15, 45, 90, 180, 360].find((part) => high - low <= 9 * part);
    const step = angle || power * ([1, 2, 5].find((factor) => rough / power <= factor) ?? 10), values = [];
    for (let index = Math.ceil(low / step); index * step <= high; ++index) values.push(to(axis, index * step));
    return values;
  }
  const place = (panel, name, value) => {
    const [a, b] = panel.range[name], share = (to(panel[name], value) - a) / (b - a);
    return name === 'x' ? left + share * panel.width : top + (1 - share) * panel.height;
  };

  const shows_decades = (axis, [a, b]) => axis.logarithmic && b - a > 2.5;
  // Many decades as plain numbers would touch each other.
  const tick = (axis, range, value) => number(from(axis, value), shows_decades(axis, range) ? 1e4 : 1e6);

  // Drawing
  function path(panel, curve) {
    const at = (point, value) => `${place(panel, 'x', point.x).toFixed(2)},${place(panel, 'y', value).toFixed(2)}`;
    return curve.segments.filter((segment) => segment.length > 0).map((segment) => {
      if (curve.mark !== 'band') return 'M' + segment.map((point) => at(point, point.y)).join('L');
      const back = [...segment].reverse().map((point) => at(point, point.lower));
      return 'M' + segment.map((point) => at(point, point.upper)).concat(back).join('L') + 'Z';
    }).join('');
  }
  function draw(panel) {
    const {svg, width, height} = panel;
    svg.replaceChildren();
    node('clipPath', {id: panel.id}, svg).append(node('rect', {x: left, y: top, width, height}));
    for (const name of ['x', 'y']) {
      for (const value of ticks(panel[name], panel.range[name])) {
        const at = place(panel, name, from(panel[name], value)), text = tick(panel[name], panel.range[name], value);
        node('path', {class: 'grid', d: name === 'x' ? `M${at},${top}v${height}` : `M${left},${at}h${width}`}, svg);
        if (name === 'x') node('text', {x: at, y: top + height + 18, 'text-anchor': 'middle'}, svg, text);
        else node('text', {x: left - 7, y: at + 4, 'text-anchor': 'end'}, svg, text);
      }
    }
    const middle = top + height / 2;
    node('text', {x: left + width / 2, y: 18, 'text-anchor': 'middle', class: 'title'}, svg, plain(panel.title));
    node('text', {x: left + width / 2, y: top + height + 42, 'text-anchor': 'middle'}, svg, plain(panel.x.label));
    const upward = {x: 14, y: middle, 'text-anchor': 'middle', transform: `rotate(-90 14 ${middle})`};
    node('text', upward, svg, plain(panel.y.label));
    const area = node('g', {'clip-path': `url(#${panel.id})`}, svg);
    for (const curve of panel.curves.filter((each) => each.group.shown)) {
      const group = node('g', {class: curve.mark, style: `--c:${curve.group.colour}`}, area);
      if (!curve.mark.endsWith('points') || curve.mark === 'line_points') node('path', {d: path(panel, curve)}, group);
      if (!curve.mark.endsWith('points')) continue;
      for (const point of curve.points) {
        const cx = place(panel, 'x', point.x), cy = place(panel, 'y', point.y);
        if (Number.isFinite(cx + cy)) node('circle', {cx, cy, r: 3.2}, group);
      }
    }
    node('rect', {x: left, y: top, width, height, class: 'frame'}, svg);
    panel.marks = node('g', {'clip-path': `url(#${panel.id})`, class: 'marks'}, svg);
    panel.box = node('rect', {class: 'box', width: 0, height: 0}, svg);
  }

  // The point under the pointer, and its companions in the other panels
  const shown = (panel) => panel.curves.filter((curve) => curve.group.shown && curve.mark !== 'band');
  const is_inside = (panel, x, y) => x >= left && x <= left + panel.width && y >= top && y <= top + panel.height;
  const is_visible = (panel, point) => is_inside(panel, place(panel, 'x', point.x), place(panel, 'y', point.y));
  function nearest(panel, x, y) {
    let best = null, least = reach;
    for (const curve of shown(panel)) {
      for (const point of curve.points.filter((each) => is_visible(panel, each))) {
        const distance = Math.hypot(place(panel, 'x', point.x) - x, place(panel, 'y', point.y) - y);
        // The data lie on top, and count so.
        if (distance < least || (distance === least && best)) [best, least] = [{curve, point}, distance];
      }
    }
    return best;
  }
  const tooltip = element('div', document.body, {className: 'tooltip', hidden: true});
  tooltip.setAttribute('role', 'status');
  function point_at(panel, found) {
    for (const other of panel.company()) {
      other.marks.replaceChildren();
      for (const curve of found ? shown(other) : []) {
        const point = curve.points.find((each) => each.at === found.point.at);
        if (point) {
          const where = {cx: place(other, 'x', point.x), cy: place(other, 'y', point.y)};
          node('circle', {...where, r: 6, style: `--c:${curve.group.colour}`}, other.marks);
        }
      }
    }
    tooltip.hidden = !found;
    if (!found) return;
    const {curve, point} = found;
    const rows = [[panel.x.label, point.x], [panel.y.label, point.y]];
    if (point.at !== point.x) rows.unshift([panel.at_label(), point.at]);
    tooltip.replaceChildren();
    write(curve.group.label || 'line', element('b', tooltip));
    for (const [label, value] of rows) {
      const row = element('div', tooltip);
      write(label + ': ', row);
      element('output', row, {textContent: number(value)}).dataset.value = value;
    }
    const frame = panel.svg.getBoundingClientRect(), scale = frame.width / (left + panel.width + right);
    const at = [frame.left + scale * place(panel, 'x', point.x), frame.top + scale * place(panel, 'y', point.y)];
    const beyond = at[0] + 14 + tooltip.offsetWidth > document.documentElement.clientWidth;
    tooltip.style.left = `${at[0] + scrollX + (beyond ? -14 - tooltip.offsetWidth : 14)}px`;
    tooltip.style.top = `${at[1] + scrollY + 10}px`;
    panel.found = found;
  }

  // Zoom; panels over the same frequency keep the same range of it
  function show(panel, x, y) {
    set_range(panel, x, y);
    for (const other of panel.company()) {
      const is_aside = other !== panel && !panel.equal_axes && other.x.label === panel.x.label;
      if (is_aside) set_range(other, panel.range.x, other.range.y);
      draw(other);
    }
    tooltip.hidden = true;
  }
  const reset = (panel) => show(panel, fitted(panel, 'x'), fitted(panel, 'y'));
  function answer(panel) {
    const {svg} = panel;
    let start = null;
    const position = (event) => {
      const frame = svg.getBoundingClientRect(), scale = (left + panel.width + right) / frame.width;
      return [(event.clientX - frame.left) * scale, (event.clientY - frame.top) * scale];
    };
    const value_at = (name, [x, y]) => {
      const [a, b] = panel.range[name], share = name === 'x' ? (x - left) / panel.width : 1 - (y - top) / panel.height;
      return a + Math.min(1, Math.max(0, share)) * (b - a);
    };
    svg.addEventListener('pointerdown', (event) => {
      if (event.button === 0 && is_inside(panel, ...position(event))) start = position(event);
    });
    svg.addEventListener('pointermove', (event) => {
      const [x, y] = position(event);
      if (!start) return point_at(panel, nearest(panel, x, y));
      const [x0, y0] = start;
      const box = {x: Math.min(x, x0), y: Math.min(y, y0), width: Math.abs(x - x0), height: Math.abs(y - y0)};
      for (const key in box) panel.box.setAttribute(key, box[key]);
    });
    svg.addEventListener('pointerup', (event) => {
      const [a, b] = [start, position(event)];
      start = null;
      panel.box.setAttribute('width', 0);
      if (!a || Math.abs(a[0] - b[0]) < 8 || Math.abs(a[1] - b[1]) < 8) return;
      const ends = (name) => [value_at(name, a), value_at(name, b)].sort((one, two) => one - two);
      show(panel, ends('x'), ends('y'));
    });
    svg.addEventListener('pointerleave', () => {
      start = null;
      panel.box.setAttribute('width', 0);
      point_at(panel, null);
    });
    svg.addEventListener('dblclick', () => reset(panel));
    svg.addEventListener('keydown', (event) => {
      const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
      if (event.key === 'Escape') reset(panel);
      const curve = panel.found?.curve ?? shown(panel).at(-1);
      if (!step || !curve) return;
      event.preventDefault();
      const point = curve.points[curve.points.indexOf(panel.found?.point) + step];
      if (point) point_at(panel, {curve, point});
    });
  }

  function csv(panels) {
    const quoted = (text) => `"${plain(text).replaceAll('"', '""')}"`;
    const lines = ['panel,curve,x_label,y_label,x,y,lower,upper'];
    for (const panel of panels) {
      // Curves without a name mark points of others.
      for (const curve of panel.curves.filter((each) => each.group.shown && each.group.label)) {
        for (const point of curve.points.filter((each) => is_visible(panel, each))) {
          const words = [panel.title, curve.group.label, panel.x.label, panel.y.label].map(quoted);
          lines.push([...words, point.x, point.y, point.lower, point.upper].join());
        }
      }
    }
    return lines.join('\n') + '\n';
  }

  // Panels side by side, or below each other where a screen is narrow, so that their words stay readable
  const narrow = matchMedia('(max-width:640px)');
  function arrange(data, grid) {
    const columns = narrow.matches ? 1 : Math.min(data.columns, data.panels.length);
    grid.style.gridTemplateColumns = `repeat(${columns},1fr)`;
    for (const panel of data.panels) {
      const wide = Math.min(panel.wide, columns);
      panel.width = (narrow.matches ? 500 : 980) / columns * wide - left - right;
      panel.height = data.panel_height * panel.tall + (panel.tall - 1) * (top + bottom);
      panel.svg.setAttribute('viewBox', `0 0 ${left + panel.width + right} ${top + panel.height + bottom}`);
      panel.svg.style.gridArea = `span ${panel.tall}/span ${wide}`;
      set_range(panel, fitted(panel, 'x'), fitted(panel, 'y'));
      draw(panel);
    }
  }

  // One picture
  const linked = new Map();  // panels by the link of their pictures
  document.querySelectorAll('script.figure-data').forEach((script) => {
    const data = JSON.parse(script.textContent), figure = script.parentElement, groups = new Map();
    const live = element('div', figure, {className: 'live'});
    script.before(live);
    const bar = element('div', live, {className: 'bar'}), grid = element('div', live, {className: 'panels'});
    if (!linked.has(data.link)) linked.set(data.link, []);
    data.panels.forEach((panel, index) => {
      panel.id = `${data.name}-live-${index}`;
      panel.company = () => linked.get(data.link);
      panel.at_label = () => data.panels.find((other) => other.x.logarithmic)?.x.label ?? '';
      for (const curve of panel.curves) {
        const named = ([x, y, lower = y, upper = y, at = x]) => ({x, y, lower, upper, at});
        curve.segments = curve.segments.map((segment) => segment.map(named));
        curve.points = curve.segments.flat();
        const key = curve.colour + curve.mark;
        const colour = curve.colour === '#222222' ? 'var(--ink)' : curve.colour;
        if (!groups.has(key)) groups.set(key, {label: '', colour, mark: curve.mark, shown: true});
        curve.group = groups.get(key);
        curve.group.label ||= curve.label;
      }
      panel.svg = node('svg', {tabindex: 0, 'aria-label': plain(panel.title)}, grid);
      answer(panel);
      linked.get(data.link).push(panel);
    });
    arrange(data, grid);
    narrow.addEventListener('change', () => arrange(data, grid));
    for (const group of groups.values()) {
      if (!group.label) continue;
      const label = element('label', bar), box = element('input', label, {type: 'checkbox', checked: true});
      element('i', label, {className: group.mark}).style.setProperty('--c', group.colour);
      write(group.label, element('span', label));
      box.addEventListener('change', () => {
        group.shown = box.checked;
        data.panels.forEach(draw);
      });
    }
    const button = (text, act) =>
      element('button', bar, {type: 'button', textContent: text}).addEventListener('click', act);
    button('Whole range', () => data.panels.forEach(reset));
    button('Shown data as CSV', () => {
      const file = new Blob([csv(data.panels)], {type: 'text/csv'});
      const link = element('a', bar, {download: `${data.name}.csv`, href: URL.createObjectURL(file)});
      link.click();
      link.remove();
    });
  });
})();

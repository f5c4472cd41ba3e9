/* The curves of the series on one axis of time: uPlot is in the page before this. Pointing at a time shows the values
   then in all curves; a click shows the liquid of this time. */
'use strict';
(function () {
  const data = JSON.parse(document.getElementById('series').textContent);
  const place = document.getElementById('curves'), HEIGHT = 130, plots = [];
  const number = value => value == null ? 'none' : +value.toPrecision(4) + '';
  const marked = unit => (plot, values) => values.map(value => number(value) + (unit ? ' ' + unit : ''));

  function plot(curve, place) {
    const head = document.createElement('div'), name = document.createElement('b');
    const value = document.createElement('output');
    name.textContent = curve.title;
    head.append(name, ' ', value);
    place.appendChild(head);
    const read = {
      setCursor: [function (plot) {
        const k = plot.cursor.idx;
        const beside = curve.reference ? `, reference ${number(curve.reference[k])}` : '';
        value.textContent = k == null ? '' : `${number(curve.values[k])} ${curve.unit} at ${
          number(data.time[k])} ${data.unit}${beside}`;
      }],
      ready: [plot => plot.over.addEventListener('click', () => document.dispatchEvent(
        new CustomEvent('moment', {detail: data.time[plot.cursor.idx] / data.factor})))]
    };
    return new uPlot({
      width: place.clientWidth, height: HEIGHT, legend: {show: false}, hooks: read,
      pxAlign: false, cursor: {sync: {key: 'time'}, y: false, drag: {x: false, y: false}},
      scales: {x: {time: false}},
      axes: [{values: marked(data.unit), size: 28, space: 90}, {values: marked(curve.unit), size: 90, space: 25}],
      series: [{}, {stroke: '#0072B2', width: 1.5, pxAlign: 0, points: {show: false}}, ...(curve.reference ? [
        {stroke: '#444', width: 1.2, dash: [6, 4], pxAlign: 0, points: {show: false}}] : [])]
    }, [data.time, curve.values, ...(curve.reference ? [curve.reference] : [])], place);
  }

  /* Groups of curves; those that are folded draw themselves when they are opened, since they have no width before. */
  for (const group of data.groups) {
    const fold = document.createElement('details'), title = document.createElement('summary');
    let drawn = false;
    title.textContent = `${group.title} (${group.curves.length})`;
    fold.append(title);
    place.appendChild(fold);
    const draw = () => {
      if (drawn || !fold.open) return;
      drawn = true;
      for (const curve of group.curves) plots.push(plot(curve, fold));
    };
    fold.addEventListener('toggle', draw);
    fold.open = group.open;
    draw();
  }
  window.addEventListener('resize', () => plots.forEach(
    plot => plot.setSize({width: place.clientWidth, height: HEIGHT})));
})();

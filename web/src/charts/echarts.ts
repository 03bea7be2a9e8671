// ECharts with only the parts that the figures use, so that the bundle contains nothing else of it.
// ECharts was chosen because one library draws lines, boxes, heat maps and parallel axes, both in
// the browser and, as text, without one.
import { BarChart, BoxplotChart, CustomChart, HeatmapChart, LineChart, ParallelChart, ScatterChart } from 'echarts/charts';
import {
  GridComponent,
  LegendComponent,
  LegendScrollComponent,
  MarkAreaComponent,
  MarkLineComponent,
  MarkPointComponent,
  ParallelComponent,
  TitleComponent,
  TooltipComponent,
  VisualMapComponent,
} from 'echarts/components';
import * as echarts from 'echarts/core';
import { LabelLayout } from 'echarts/features';
import { SVGRenderer } from 'echarts/renderers';

echarts.use([
  BarChart,
  BoxplotChart,
  CustomChart,
  HeatmapChart,
  LineChart,
  ParallelChart,
  ScatterChart,
  GridComponent,
  LegendComponent,
  LegendScrollComponent,
  MarkAreaComponent,
  MarkLineComponent,
  MarkPointComponent,
  ParallelComponent,
  TitleComponent,
  TooltipComponent,
  VisualMapComponent,
  SVGRenderer,
  LabelLayout,
]);

// ECharts takes the width of this letter as the height of a line. Where no font has the letter, its width depends on the
// fonts that are installed, and labels would overlap. So it is as wide as the font is high, as it is without a browser.
const kWideLetter = '\u56fd';
const context = typeof document === 'undefined' ? null : document.createElement('canvas').getContext('2d');
if (context !== null) {
  echarts.setPlatformAPI({
    measureText(text: string, font = '12px sans-serif') {
      if (text === kWideLetter) {
        return { width: parseFloat(/[\d.]+(?=px)/.exec(font)?.[0] ?? '12') };
      }
      context.font = font;
      return context.measureText(text);
    },
  });
}

export { echarts };
export type { EChartsCoreOption as EChartsOption, EChartsType } from 'echarts/core';

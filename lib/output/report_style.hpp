// Private header: how a report looks on a screen, on a telephone, and on paper.
#pragma once

namespace apothem {

inline constexpr const char* kReportStyle = R"(
body { font: 16px/1.5 sans-serif; max-width: 1200px; margin: 2em auto; padding: 0 1em; color: #222; }
h2 { margin-top: 2.5em; border-top: 2px solid #ccc; padding-top: .7em; }
h3 { font-size: 1em; margin-bottom: .3em; }
summary { cursor: pointer; margin-top: 1em; }
summary h3 { display: inline; }
img { max-width: 100%; height: auto; }
.picture, .numbers { overflow-x: auto; }
table { border-collapse: collapse; font-size: 14px; }
th, td { padding: .2em .6em; text-align: left; vertical-align: top; border-bottom: 1px solid #ddd; }
td { overflow-wrap: break-word; }
th.number, td.number { text-align: right; }
td.number { font-variant-numeric: tabular-nums; }
td.number, td.verdict { white-space: nowrap; }
tr.missed, p.fault { background: #fde2dd; font-weight: bold; }
pre { background: #f3f3f3; padding: .5em; white-space: pre-wrap; overflow-wrap: anywhere; font-size: 13px; }
dt { font-weight: bold; }
dd { margin: 0 0 .6em 1.2em; }
.badge { display: inline-block; border-radius: .3em; padding: 0 .5em; font-weight: bold; border: 1px solid; }
.reproduced { background: #ddf0dd; color: #14521a; }
.explained, .alike { background: #fff0cc; color: #604a00; white-space: nowrap; }
.not_confirmed, .missing { background: #fde2dd; color: #801c10; }
.own { background: #e6e9f2; color: #2c3a66; }
p.top { font-size: 14px; }
/* On a narrow screen every row is a list of its cells, each behind the head of its column, numbers
   two in a line, and pictures stay large enough to read: they scroll. */
@media screen and (max-width: 800px) {
  body { margin: 1em auto; padding: 0 .7em; }
  h1 { font-size: 1.5em; }
  .explained, .alike { white-space: normal; }
  .picture img { max-width: none; width: 680px; }
  .picture::before { content: "scrolls sideways \2192"; display: block; position: sticky; left: 0; color: #666; font-size: 13px; }
  table, tbody, td { display: block; }
  thead { display: none; }
  tr { display: flex; flex-wrap: wrap; border: 1px solid #ccc; margin-bottom: .8em; padding: .3em; }
  td, td.number { flex: 0 0 100%; box-sizing: border-box; text-align: left; border: 0; padding: .1em 0 .1em 5.5em;
    position: relative; min-height: 1.4em; }
  td.number, td.verdict { flex: 0 0 auto; min-width: 50%; padding-left: 0; }
  td.none { display: none; }
  td::before { content: attr(data-head); position: absolute; left: 0; color: #666; font-weight: normal; }
  /* A long head moves its number, and does not lie on it. */
  td.number::before, td.verdict::before { position: static; display: inline-block; min-width: 5em; padding-right: .5em; }
}
@media print {
  body { font-size: 11pt; margin: 0; max-width: none; }
  table { font-size: 7.5pt; }
  th, td { padding: .15em .35em; }
  pre { font-size: 7.5pt; }
  h2 { break-before: page; border: 0; margin-top: 0; }
  #figures { break-before: auto; }
  h3 { break-after: avoid; }
  .picture, .numbers { overflow: visible; }
  .picture img { max-width: 100%; max-height: 22cm; width: auto; }
  tr, .picture, dl > div { break-inside: avoid; }
  p.top, .players { display: none; }
  a { color: inherit; text-decoration: none; }
}
)";

}  // namespace apothem

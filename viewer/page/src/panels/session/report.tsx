// The report of a solve: its words and tables come from the bridge, as calib/present/report has them.
import type { CameraReport, Report } from "../../protocol";
import { images } from "../../store";
import { TableView } from "./table";

function CameraSection({ report, open }: { report: CameraReport; open: boolean }) {
  return (
    <details class="card" open={open} data-testid={`report-${report.camera}`}>
      <summary>{report.camera}</summary>
      {report.tables.map((table) => <TableView key={table.title} table={table} />)}
    </details>
  );
}

interface PicturesProps {
  view: string; // of the images
  title: string;
  words: string;
}

/// One kind of the report's pictures, each camera's.
function Pictures({ view, title, words }: PicturesProps) {
  const pictures = [...images.value.values()].filter(({ header }) => header.view === view);
  if (pictures.length === 0) return null;
  return (
    <section class="card" data-testid={`pictures-${view}`}>
      <h3>{title}</h3>
      <p class="muted">{words}</p>
      <div class="pictures several">
        {pictures.map(({ header, url }) => (
          <figure key={header.camera} class="sigma-picture">
            <img src={url} alt={`${title}: ${header.camera}`} />
            <figcaption>{header.camera}</figcaption>
          </figure>
        ))}
      </div>
    </section>
  );
}

/// The report's pictures.
export function ReportPictures() {
  return (
    <>
      <Pictures view="sigma" title="Projection uncertainty"
        words="1 sigma of the position at which a point is projected into the image, over the whole image." />
      <Pictures view="lidar" title="LIDAR errors"
        words="True minus measured range, by ring and by intensity, and by how much a board is enlarged at its edges, as estimated with each camera. Bars: 1 sigma." />
    </>
  );
}

/// `open`: unfolded, where there is nothing to do but to read.
export function ReportSection({ report, open }: { report: Report; open: boolean }) {
  return (
    <section aria-label="Report" data-testid="report">
      <h2>Report</h2>
      <p class="muted">{report.intro}</p>
      {report.cameras.map((camera) => <CameraSection key={camera.camera} report={camera} open={open} />)}
      {report.tables.map((table) => <div key={table.title} class="card"><TableView table={table} /></div>)}
    </section>
  );
}

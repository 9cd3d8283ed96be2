// A spinning LIDAR of your own for rgbdt: publishes a sweep a second on CLOUD until it is stopped.
// Needs Debian's default-jdk-headless and liblcm-java. From the repository's root:
//   cmake --preset release -DRGBDT_JAVA=ON && cmake --build build --target rgbdt_lcmtypes_jar
//   jars=/usr/share/java/lcm.jar:build/java/rgbdt.jar
//   javac -cp $jars -d out/classes scripts/examples/PublishCloud.java
//   java -cp $jars:out/classes PublishCloud
import lcm.lcm.LCM;
import rgbdt.cloud_t;

public class PublishCloud {
  static final int RINGS = 16, COLUMNS = 900;

  static cloud_t sweep(long seq, long utime) {
    int n = RINGS * COLUMNS;
    cloud_t c = new cloud_t();
    c.utime = c.sweep_utime = utime; // of the first point, on the clock that the cameras share
    c.seq = seq;
    c.organised = true;
    c.num_lines = RINGS;
    c.num_beams = COLUMNS;
    c.num_points = n;
    c.x_m = new float[n]; c.y_m = new float[n]; c.z_m = new float[n];
    c.intensity = new float[n];
    c.utime_offset_us = new int[n];
    c.ring = new short[n];
    c.origin_x_m = c.origin_y_m = c.origin_z_m = new float[0]; // all beams start in the origin
    c.num_misses = n / 2; // of 450 columns in front nothing comes back
    c.miss_index = new int[n / 2];
    c.miss_x = new float[n / 2]; c.miss_y = new float[n / 2]; c.miss_z = new float[n / 2];
    for (int i = 0, miss = 0; i < n; i++) {
      int ring = i / COLUMNS, column = i % COLUMNS;
      double up = Math.toRadians(2 * ring - 15), around = 2 * Math.PI * column / COLUMNS;
      double x = Math.cos(up) * Math.cos(around), y = Math.cos(up) * Math.sin(around);
      boolean hit = column >= COLUMNS / 2; // a sphere of 4 m
      c.x_m[i] = hit ? (float) (4 * x) : Float.NaN;
      c.y_m[i] = hit ? (float) (4 * y) : Float.NaN;
      c.z_m[i] = hit ? (float) (4 * Math.sin(up)) : Float.NaN;
      c.intensity[i] = hit ? 0.5f : Float.NaN;
      c.utime_offset_us[i] = 1000000 / COLUMNS * column;
      c.ring[i] = (short) ring;
      if (hit) continue;
      c.miss_index[miss] = i;
      c.miss_x[miss] = (float) x; c.miss_y[miss] = (float) y;
      c.miss_z[miss++] = (float) Math.sin(up);
    }
    c.sweep_end = true; // one message is the whole sweep
    c.sweep_lines = RINGS;
    return c;
  }

  public static void main(String[] args) throws Exception {
    LCM lcm = new LCM(); // LCM_DEFAULT_URL says which bus
    for (long seq = 0;; seq++) {
      long begun = System.currentTimeMillis() * 1000;
      Thread.sleep(1000); // the sweep is turning
      lcm.publish("CLOUD", sweep(seq, begun));
    }
  }
}

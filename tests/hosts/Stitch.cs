// A host in C#: steps a scene, moves a tool, reads a force and a mesh, saves the state.
//
//   mono Stitch.exe SCENE STEPS OUTPUT.NAME STATE-FILE [TOOL]
using System;
using System.Runtime.InteropServices;
using System.Text;

static class Sutura {
  const string Library = "sutura";  // libsutura.so

  [StructLayout(LayoutKind.Sequential)]
  public struct Report {
    public uint StructSize;
    public int Solved;
    public long Step;
    public double Time, Dt, Duration;
    public long Rows, Passes, Parts, Events, Faults;
    public double Imbalance, Violation, Seconds;
    public long Missed;
  }

  [StructLayout(LayoutKind.Sequential)]
  public struct Geometry {
    public uint StructSize, Corners;
    public ulong Topology;
    public IntPtr Path;
    public UIntPtr PointCount;
    public IntPtr Points;  // PointCount x 3 doubles, m
    public UIntPtr CellCount;
    public IntPtr Cells;  // CellCount x Corners longs
    public UIntPtr FieldCount;
  }

  // Text is UTF-8 and ends with 0: Bytes makes it.
  [DllImport(Library)] static extern IntPtr sutura_error();
  [DllImport(Library)] public static extern uint sutura_api();
  [DllImport(Library)] public static extern int sutura_load(byte[] file, IntPtr options,
                                                            out ulong simulation);
  [DllImport(Library)] public static extern int sutura_destroy(ulong simulation);
  [DllImport(Library)] public static extern int sutura_step(ulong simulation, UIntPtr count);
  [DllImport(Library)] public static extern int sutura_start_recording(ulong simulation);
  [DllImport(Library)] public static extern int sutura_finish_recording(ulong simulation);
  [DllImport(Library)] public static extern int sutura_get_report(ulong simulation, ref Report r);
  [DllImport(Library)] public static extern int sutura_save_file(ulong simulation, byte[] file);
  [DllImport(Library)] public static extern int sutura_find_output(ulong simulation, byte[] name,
                                                                   out ulong output);
  [DllImport(Library)] public static extern int sutura_get_output(ulong output, double[] values,
                                                                  UIntPtr count);
  [DllImport(Library)] public static extern int sutura_body_at(ulong simulation, UIntPtr number,
                                                               out ulong body);
  [DllImport(Library)] public static extern int sutura_get_geometry(ulong body, ref Geometry g);
  [DllImport(Library)] public static extern int sutura_find_tool(ulong simulation, byte[] path,
                                                                 out ulong tool);
  [DllImport(Library)] public static extern int sutura_get_pose(ulong tool, double[] pose);
  [DllImport(Library)] public static extern int sutura_set_pose(ulong tool, double[] pose);

  public static byte[] Bytes(string text) {
    return Encoding.UTF8.GetBytes(text + '\0');
  }

  /// Throws the sentence of a call that failed.
  public static void Need(int status) {
    if (status != 0) throw new InvalidOperationException(Marshal.PtrToStringAnsi(sutura_error()));
  }

  /// The points of a body, copied: x y z, x y z, ...
  public static double[] Points(ulong body) {
    var g = new Geometry { StructSize = (uint)Marshal.SizeOf(typeof(Geometry)) };
    Need(sutura_get_geometry(body, ref g));
    var points = new double[3 * (int)g.PointCount];
    Marshal.Copy(g.Points, points, 0, points.Length);
    return points;
  }
}

static class Stitch {
  static int Main(string[] args) {
    if (args.Length < 4 || Sutura.sutura_api() != 1) return 1;
    ulong simulation, output, body, tool;
    var force = new double[3];
    double largest = 0;
    Sutura.Need(Sutura.sutura_load(Sutura.Bytes(args[0]), IntPtr.Zero, out simulation));
    Sutura.Need(Sutura.sutura_find_output(simulation, Sutura.Bytes(args[2]), out output));
    Sutura.Need(Sutura.sutura_body_at(simulation, UIntPtr.Zero, out body));
    Sutura.Need(Sutura.sutura_start_recording(simulation));  // files go to out/NAME
    for (int i = 0; i < int.Parse(args[1]); ++i) {
      if (args.Length > 4) {  // a tenth of a millimetre up in each step
        var pose = new double[7];
        Sutura.Need(Sutura.sutura_find_tool(simulation, Sutura.Bytes(args[4]), out tool));
        Sutura.Need(Sutura.sutura_get_pose(tool, pose));
        pose[2] += 1e-4;
        Sutura.Need(Sutura.sutura_set_pose(tool, pose));
      }
      Sutura.Need(Sutura.sutura_step(simulation, (UIntPtr)1));
      Sutura.Need(Sutura.sutura_get_output(output, force, (UIntPtr)3));
      foreach (double f in force) largest = Math.Max(largest, Math.Abs(f));
    }
    var report = new Sutura.Report { StructSize = (uint)Marshal.SizeOf(typeof(Sutura.Report)) };
    Sutura.Need(Sutura.sutura_get_report(simulation, ref report));
    Sutura.Need(Sutura.sutura_save_file(simulation, Sutura.Bytes(args[3])));
    Sutura.Need(Sutura.sutura_finish_recording(simulation));
    Console.WriteLine("{0} steps, {1} s simulated, {2} up to {3:R} N, {4} points", report.Step,
                      report.Time, args[2], largest, Sutura.Points(body).Length / 3);
    Sutura.Need(Sutura.sutura_destroy(simulation));
    try {
      Sutura.Need(Sutura.sutura_step(simulation, (UIntPtr)1));
    } catch (InvalidOperationException misuse) {
      Console.WriteLine("as it must be: " + misuse.Message);
      return 0;
    }
    return 1;
  }
}

"""Numbers that go into plots and pages."""

import unittest
from unittest import mock

import numpy as np
from fixture import LauncherTest

import sample_run
from gabion_tools import comparison, history_plots, plots, run_data, section_plot


class PlotsTest(LauncherTest):
    def test_every_plot_of_a_full_run_is_drawn(self):
        sample_run.write(self.folder / "a")
        made, failed = plots.draw(self.folder / "a")
        self.assertEqual(failed, [])
        self.assertEqual({path.stem for path in made},
                         {"energy", "probes", "block", "reactions", "monitor", "section", "crater", "interface"})

    def test_a_broken_file_costs_one_plot(self):
        sample_run.write(self.folder / "a")
        (self.folder / "a" / "results.h5").write_bytes(b"not this")
        with mock.patch.object(plots, "PLOTS", [section_plot.section, history_plots.block]):
            made, failed = plots.draw(self.folder / "a")
        self.assertEqual(len(failed), 1)
        self.assertIn("section: OSError", failed[0])
        self.assertEqual([path.stem for path in made], ["block"])

    def test_an_empty_run_has_no_plots(self):
        (self.folder / "a").mkdir()
        (self.folder / "a" / "energy.csv").write_text("time [s],balance [J]\n", encoding="utf-8")
        self.assertEqual(plots.draw(self.folder / "a"), ([], []))

    def test_a_row_that_is_being_written_is_left_out(self):
        path = self.folder / "a.csv"
        path.write_text("time [s],x [m]\n0,1\n0.1,nan\n0.2", encoding="utf-8")
        table = run_data.read_csv(path)
        self.assertEqual(list(table["time [s]"]), [0.0, 0.1])
        self.assertTrue(np.isnan(table["x [m]"][1]))

    def test_tables_that_a_later_stage_continued(self):
        joined = run_data.joined({"reactions": {"time [s]": np.array([0.0]), "a [N]": np.array([1.0])},
                                  "reactions-2": {"time [s]": np.array([1.0]), "b [N]": np.array([2.0])}})
        np.testing.assert_equal(joined, {"reactions": {"time [s]": [0.0, 1.0], "a [N]": [1.0, np.nan],
                                                       "b [N]": [np.nan, 2.0]}})

    def test_the_filtered_force_is_a_centred_mean(self):
        time = np.linspace(0, 0.1, 1001)
        middles = time - 0.5 * (time[1] - time[0])  # of the intervals that end at the times
        wave = run_data.centred_mean(time, np.sin(2 * np.pi * middles / 0.004), 0.004)
        self.assertLess(np.abs(wave[20:-20]).max(), 1e-3)
        np.testing.assert_allclose(run_data.centred_mean(time, 3 * middles)[20:-20], 3 * time[20:-20], atol=1e-4)
        table = run_data.with_filtered_force({"time [s]": time, "force_mean.z [N]": np.full(1001, 7.0)})
        np.testing.assert_allclose(table["force_filtered [N]"], 7.0)

    def test_a_plane_cuts_a_cube_in_a_square(self):
        nodes = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
        (polygon, element), = section_plot.cut_elements(nodes, np.arange(8).reshape(1, 8), 1, 0.25)
        self.assertEqual(element, 0)
        self.assertEqual({tuple(corner) for corner in polygon}, {(0, 0), (1, 0), (1, 1), (0, 1)})
        shifted = np.roll(polygon, -1, axis=0)
        area = 0.5 * abs(np.sum(polygon[:, 0] * shifted[:, 1] - polygon[:, 1] * shifted[:, 0]))
        self.assertAlmostEqual(area, 1.0)
        self.assertEqual(section_plot.cut_elements(nodes, np.arange(8).reshape(1, 8), 1, 1.5), [])

    def test_small_displacements_are_magnified_to_a_round_factor(self):
        self.assertEqual(section_plot.magnified(np.array([[0, 0, 1e-4]]), 3.0), 500.0)
        self.assertEqual(section_plot.magnified(np.array([[0, 0, 0.5]]), 3.0), 1.0)

    def test_comparison_shows_what_the_runs_share(self):
        for name, model in (("a", "dem"), ("b", "edge")):
            sample_run.write(self.folder / name, model)
        comparison.write(self.folder, [self.folder / "a", self.folder / "b"])
        page = (self.folder / "compare.html").read_text(encoding="utf-8")
        self.assertGreaterEqual(page.count("data:image/png"), 5)
        self.assertIn("<b>edge</b>", page)


if __name__ == "__main__":
    unittest.main()

"""Simulations: stepped, looked at, saved and gone on with; the results are those of the program."""
import ctypes
import gc
import json
import os
import signal
import subprocess
import sys
import threading
import time
import unittest
import weakref

import apothem
import numpy
from support import PROGRAM, SOURCE, FolderCase, beam, falling_block, flying_block


def simulation(document, **options):
    return apothem.Simulation(apothem.Scene(document), **options)


def hash_of_program(file, folder, *options):
    subprocess.run([PROGRAM, "run", file, "-o", folder, "--quiet", *options], check=True)
    return json.loads((folder / "run.json").read_text())["final_state_hash"]


class Running(FolderCase):
    def test_the_results_are_those_of_the_program_bit_for_bit(self):
        for name in ["crosses-collide", "incline-down-mu-02", "oblique-discs", "arch-falls"]:
            file = SOURCE / f"data/scenes/{name}.json"
            with self.subTest(name=name):
                end = apothem.load(file).end / 20
                whole = hash_of_program(file, self.folder / name, "--until", str(end))
                ran = apothem.Simulation(apothem.load(file))
                ran.run(until=end)
                self.assertEqual(ran.state_hash(), whole)
                stepped = apothem.Simulation(apothem.load(file), threads=2)
                while stepped.steps < ran.steps:
                    self.assertEqual(stepped.step(), 1)
                self.assertEqual(stepped.state_hash(), whole)

    def test_files_are_those_of_the_program(self):
        file = self.folder / "scene.json"
        file.write_text(json.dumps(falling_block()))
        hash_of_program(file, self.folder / "program")
        with apothem.Simulation(apothem.load(file), output=self.folder / "python") as sim:
            sim.run(until=0.1)
            self.assertGreater((self.folder / "python/history.csv").stat().st_size, 0)
            sim.run()
        for name in ["history.csv", "energy.csv", "momentum.csv", "frames.pvd", "final.json"]:
            with self.subTest(name=name):
                self.assertEqual((self.folder / "python" / name).read_bytes(),
                                 (self.folder / "program" / name).read_bytes())
        self.assertEqual(json.loads((self.folder / "python/run.json").read_text())["status"], "done")
        with self.assertRaises(RuntimeError):
            sim.step()

    def test_files_of_a_run_that_is_stepped_by_hand(self):
        rules = {"regions": {"bin": {"polygon": [[-9, -9], [9, -9], [9, 9], [-9, 9]]}},
                 "stop": [{"name": "full", "region": "bin", "count_above": 0}]}
        for name, document, status in [("end", falling_block(), "done"),
                                       ("half", falling_block(), "interrupted"),
                                       ("rule", falling_block(**rules), "done")]:
            with self.subTest(name=name):
                folder = self.folder / name
                with simulation(document, output=folder) as sim:
                    while (name != "half" or sim.steps < 1500) and sim.step():
                        pass
                self.assertEqual(json.loads((folder / "run.json").read_text())["status"], status)
                last = (folder / "history.csv").read_text().splitlines()[-1]
                self.assertEqual(float(last.split(",")[0]), sim_time(folder))

    def test_steps_and_times(self):
        sim = simulation(flying_block())
        self.assertEqual((sim.time, sim.steps, sim.step_size), (0, 0, 1e-3))
        self.assertEqual(sim.step(), 1)
        self.assertEqual(sim.step(9), 9)
        self.assertAlmostEqual(sim.time, 0.01, 14)
        self.assertTrue(sim.run(until=0.5))
        self.assertEqual(sim.steps, 500)
        self.assertFalse(sim.ended)
        self.assertEqual(sim.step(10000), 500)
        self.assertTrue(sim.ended)
        self.assertEqual(sim.step(), 0)

    def test_a_loop_in_python_takes_less_than_two_microseconds_more_per_step(self):
        document = flying_block()
        document["time"]["end"] = 1e4
        sim, count = simulation(document), 50000

        def seconds(work):
            start = time.process_time()
            work()
            return time.process_time() - start

        def loop():
            for _ in range(count):
                sim.step()

        within = min(seconds(lambda: sim.step(count)) for _ in range(3))
        calls = min(seconds(loop) for _ in range(3))
        self.assertEqual(sim.steps, 6 * count)
        self.assertLess((calls - within) / count, 2e-6)

    def test_numbers_that_are_no_times_and_no_counts(self):
        sim = simulation(flying_block())
        with self.assertRaises(ValueError):
            sim.run(until=float("nan"))
        with self.assertRaises(ValueError):
            sim.step(-5)
        self.assertEqual(sim.steps, 0)

    def test_a_rule_of_the_scene_stops_the_run(self):
        sim = simulation(flying_block(
            regions={"bin": {"polygon": [[-9, -9], [9, -9], [9, 9], [-9, 9]]}},
            stop=[{"name": "full", "region": "bin", "count_above": 0}]))
        self.assertFalse(sim.run())
        self.assertEqual(sim.stopped_by, "full")
        self.assertLess(sim.time, 1)
        self.assertEqual(sim.step(), 0)

    def test_a_static_scene_takes_load_steps(self):
        document = beam()
        document["time"] = {"end": 1, "mode": "static", "load_steps": 2}
        sim = simulation(document)
        self.assertEqual(sim.step(), 1)
        self.assertEqual(sim.time, 0.5)
        sim.run()
        self.assertLess(sim.nodes.displacement[:, 1].min(), -1e-5)

    def test_an_unstable_run(self):
        document = flying_block()
        document["time"]["end"] = 100
        sim = simulation(document)

        def explode(_, force):
            force.bodies[:] = 1e300

        sim.add_force(explode)
        with self.assertRaises(apothem.Unstable) as caught:
            sim.run()
        self.assertIn("t = ", str(caught.exception))
        with self.assertRaises(apothem.Unstable):
            sim.step()


class Views(unittest.TestCase):
    def test_arrays_are_views_that_show_the_present(self):
        sim = simulation(falling_block())
        bodies = sim.bodies
        views = [bodies.position, bodies.velocity, bodies.force]
        places = [view.__array_interface__["data"][0] for view in views]
        forces = 0
        for _ in range(2000):
            sim.step()
            forces += views[2][1, 1] != 0
            for view, now in zip(views, [sim.bodies.position, sim.bodies.velocity, sim.bodies.force]):
                self.assertTrue((view == now).all())
        self.assertGreater(forces, 100)
        self.assertEqual(places, [v.__array_interface__["data"][0] for v in
                                  [sim.bodies.position, sim.bodies.velocity, sim.bodies.force]])
        for view in views:
            self.assertEqual(view.shape, (2, 3))
            self.assertFalse(view.flags.owndata or view.flags.writeable)
            with self.assertRaises(ValueError):
                view[0, 0] = 1

    def test_a_view_keeps_its_memory(self):
        sim = simulation(flying_block())
        sim.step(10)
        bodies, position, there = sim.bodies, sim.bodies.position, weakref_of(sim)
        expected = position.copy()
        del sim
        gc.collect()
        self.assertIsNone(there())
        blocks = [numpy.full((50, 3), 7.0) for _ in range(1000)]  # what was freed is used again
        numpy.testing.assert_array_equal(position, expected)
        numpy.testing.assert_array_equal(bodies.position, expected)
        self.assertEqual(len(blocks), 1000)

    def test_a_callback_that_holds_the_simulation_does_not_keep_it(self):
        for held in [lambda sim: sim, lambda sim: sim.bodies, lambda sim: sim.bodies.position]:
            sim = simulation(flying_block())
            kept = held(sim)
            sim.on_step(lambda *_, kept=kept: kept)
            there = weakref_of(sim)
            del sim, kept
            gc.collect()
            self.assertIsNone(there())

    def test_bodies_of_a_falling_block(self):
        sim = simulation(falling_block())
        self.assertEqual(sim.bodies.names, ["plate", "block"])
        self.assertEqual(sim.bodies.mass[1], 2000)
        self.assertAlmostEqual(sim.bodies.inertia[1], 2000 / 6, 9)
        numpy.testing.assert_allclose(sim.bodies.outlines()[1][0], [0, 0.05], atol=1e-15)
        self.assertEqual(sim.origin, (0, 0))

    def test_coordinates_far_away_are_relative_to_the_origin(self):
        document = flying_block()
        document["bodies"][0]["polygon"] = [[1e6 + x, -3e6 + y] for x, y in [[0, 0], [1, 0], [0, 1]]]
        sim = simulation(document)
        numpy.testing.assert_allclose(sim.bodies.outlines()[0] + sim.origin,
                                      document["bodies"][0]["polygon"], atol=1e-9)
        self.assertLess(abs(sim.bodies.position[0, :2]).max(), 10)

    def test_bodies_that_come_and_go_have_their_rows_from_the_start(self):
        document = flying_block(
            gravity=[0, -10], contact={"normal_stiffness": 1e7},
            world={"box": [[-5, -5], [5, 5]], "outside": "remove"},
            fill=[{"name": "drop", "material": "rock", "region": [[-4, 2], [4, 2], [4, 4], [-4, 4]],
                   "shapes": [{"polygon": [[0, 0], [1, 0], [0, 1]]}], "diameter": 0.3, "count": 4,
                   "seed": 1, "repeat": {"every": 0.4, "times": 2}}])
        document["time"]["end"] = 3
        sim = simulation(document)
        position, counts = sim.bodies.position, []
        sim.on_step(lambda s: counts.append(int(s.bodies.present.sum())), every=64)
        sim.run()
        self.assertEqual(len(position), len(sim.bodies))
        self.assertGreater(max(counts), counts[0])
        self.assertEqual(counts[-1], 0)

    def test_nodes_and_elements(self):
        sim = simulation(beam())
        nodes, elements = sim.nodes, sim.elements
        displacement = nodes.displacement
        self.assertFalse(displacement.flags.owndata or displacement.flags.writeable)
        self.assertEqual((len(nodes), displacement.shape, len(elements)), (27, (27, 2), 16))
        sim.run()
        numpy.testing.assert_array_equal(nodes.position, nodes.reference + displacement)
        self.assertLess(displacement[:, 1].min(), -1e-6)
        self.assertEqual(elements.stress.shape, (16, 4))
        self.assertGreater(abs(elements.stress[:, 0]).max(), 0)
        self.assertEqual(nodes.of("beam"), slice(0, 27, 1))
        self.assertEqual(elements.of("beam"), slice(0, 16, 1))
        with self.assertRaises(KeyError):
            nodes.of("bream")
        for corners in elements.nodes:
            x, y = nodes.reference[corners].T
            self.assertAlmostEqual(sum(x * numpy.roll(y, -1) - y * numpy.roll(x, -1)) / 2, 0.25, 12)

    def test_contacts_balance_the_weight(self):
        document = falling_block()
        document["bodies"][1].update(velocity=[0, 0], spin=0)
        document["bodies"][1]["polygon"] = [[0, 0], [1, 0], [1, 1], [0, 1]]
        document["time"] = {"end": 0.1, "start": "settled"}
        sim = simulation(document)
        contacts = sim.contacts()
        self.assertEqual(list(contacts["body_a"]), [0])
        self.assertEqual(list(contacts["body_b"]), [1])
        self.assertAlmostEqual(contacts["normal"][:, 1].sum() / (-2000 * 9.81), 1, 6)
        self.assertGreater(contacts["penetration"][0], 0)
        numpy.testing.assert_allclose(contacts["point"][0], [0.5, 0], atol=1e-2)


def sim_time(folder):
    """The time at which a run has ended, s."""
    return json.loads((folder / "run.json").read_text())["time"]


def weakref_of(sim):
    return weakref.ref(sim)


class Callbacks(unittest.TestCase):
    def test_a_force_pushes_and_the_ledger_closes(self):
        sim = simulation(flying_block())

        def wind(now, force):
            force.bodies[0, 0] += 2000 * (1 + 0 * now.time)

        sim.add_force(wind, name="wind")
        sim.run(until=0.5)
        self.assertAlmostEqual(sim.bodies.velocity[0, 0], 0.5, 12)
        energies = sim.energies()
        self.assertAlmostEqual(energies["external_work"], 250, 1)
        self.assertLess(abs(energies["total_error"]), 1e-9)
        self.assertAlmostEqual(sim.momenta()["px"], 1000, 9)

    def test_a_force_on_nodes(self):
        sim = simulation(beam())

        def pull(_, force):
            force.nodes[-1] += [1e5, 0]

        sim.add_force(pull)
        sim.run()
        self.assertGreater(sim.nodes.displacement[:, 0].max(), 1e-5)

    def test_exceptions_of_a_force_end_the_simulation(self):
        sim = simulation(flying_block())
        sim.add_force(lambda now, _: 1 / (now.steps < 5))
        with self.assertRaises(ZeroDivisionError):
            sim.run()
        with self.assertRaisesRegex(RuntimeError, "force callback"):
            sim.step()

    def test_a_force_comes_before_the_first_step(self):
        sim = simulation(flying_block())
        sim.step()
        with self.assertRaisesRegex(RuntimeError, "before the first step"):
            sim.add_force(lambda *_: None)
        self.assertEqual(sim.step(), 1)

    def test_callbacks_that_are_added_in_a_step_begin_with_the_next_one(self):
        sim, calls = simulation(flying_block()), []

        def first(sim):
            calls.append("first")
            if sim.steps == 1:
                sim.on_step(lambda _: calls.append("second"))

        sim.on_step(first)
        sim.step(2)
        self.assertEqual(calls, ["first", "first", "second"])

    def test_exceptions_after_a_step_do_no_harm(self):
        document = falling_block()
        whole, sim = simulation(document), simulation(document)
        whole.run()
        calls = []

        def look(now):
            calls.append(now.steps)
            if now.steps == 500:
                raise LookupError("enough")

        sim.on_step(look, every=100)
        with self.assertRaises(LookupError):
            sim.run()
        self.assertEqual(calls, [100, 200, 300, 400, 500])
        sim.run()
        self.assertEqual(sim.state_hash(), whole.state_hash())

    def test_callbacks_must_not_step(self):
        sim = simulation(flying_block())
        sim.on_step(lambda now: now.step())
        with self.assertRaisesRegex(RuntimeError, "running already"):
            sim.step()
        self.assertEqual(sim.steps, 1)

    def test_velocities_are_set_with_their_energy(self):
        sim = simulation(falling_block())
        velocity = sim.bodies.velocity.copy()
        velocity[:, 1] = 3
        sim.set_velocities(bodies=velocity)
        numpy.testing.assert_array_equal(sim.bodies.velocity[:, 1], [0, 3])
        sim.step(100)
        energies = sim.energies()
        self.assertAlmostEqual(energies["external_work"], 9000, 6)
        self.assertLess(abs(energies["total_error"]), 1e-6)
        for bad in [velocity[:1], velocity.T, velocity * numpy.nan]:
            with self.assertRaises(ValueError):
                sim.set_velocities(bodies=bad)


class Saving(FolderCase):
    def test_a_saved_simulation_goes_on_bit_for_bit(self):
        for name, document in [("rigid", falling_block()), ("beam", beam())]:
            with self.subTest(name=name):
                whole, sim = simulation(document), simulation(document)
                whole.run()
                sim.step(50)
                sim.save(self.folder / "state.json")
                sim.step(7)
                again = apothem.resume(self.folder / "state.json")
                self.assertEqual(again.steps, 50)
                again.run()
                self.assertEqual(again.state_hash(), whole.state_hash())

    def test_with_files_and_a_force(self):
        def push(_, force):
            force.bodies[1, 0] += 500

        whole = simulation(falling_block())
        whole.add_force(push)
        whole.run()
        sim = simulation(falling_block(), output=self.folder / "first")
        sim.add_force(push)
        sim.run(until=0.15)
        sim.save(self.folder / "state.json")
        sim.close()
        later = apothem.resume(self.folder / "state.json", output=self.folder / "second")
        there = apothem.resume(self.folder / "first", apothem.Scene(falling_block()))
        for again in [later, there]:
            again.add_force(push)
            again.run()
            self.assertEqual(again.state_hash(), whole.state_hash())
            again.close()
        rows = (self.folder / "second/history.csv").read_text().splitlines()
        self.assertTrue(rows[1].startswith("0.15"), rows[1])

    def test_a_force_that_was_there_is_missed(self):
        sim = simulation(flying_block())
        sim.add_force(lambda *_: None, name="wind")
        sim.step(3)
        sim.save(self.folder / "state.json")
        for names, message in [([], '"wind"'), (["rain"], '"wind"'), (["wind"], None)]:
            again = apothem.resume(self.folder / "state.json")
            for name in names:
                again.add_force(lambda *_: None, name=name)
            if message is None:
                self.assertEqual(again.step(), 1)
                continue
            with self.assertRaisesRegex(apothem.SceneError, message):
                again.step()

    def test_a_force_that_fails_is_named_in_the_results(self):
        with self.assertRaises(ZeroDivisionError):
            with simulation(flying_block(), output=self.folder / "out") as sim:
                sim.add_force(lambda now, _: now.steps == 3 and 1 / 0)
                sim.run()
        found = json.loads((self.folder / "out/run.json").read_text())
        self.assertEqual(found["status"], "failed")

    def test_the_files_are_closed_at_the_end_of_a_script(self):
        code = ("import apothem\n"
                f"sim = apothem.Simulation(apothem.Scene({flying_block()!r}), output='out')\n"
                "position, bodies = sim.bodies.position, sim.bodies\n"
                "sim.on_step(lambda now: position)\n"
                "sim.run()\n")
        subprocess.run([sys.executable, "-c", code], cwd=self.folder, check=True)
        self.assertEqual(json.loads((self.folder / "out/run.json").read_text())["status"], "done")

    def test_what_is_no_saved_state(self):
        (self.folder / "bad.json").write_text("{}")
        with self.assertRaises(apothem.SceneError):
            apothem.resume(self.folder / "bad.json")
        with self.assertRaises(apothem.SceneError):
            apothem.resume(self.folder / "none.json")
        with self.assertRaises(OSError):
            simulation(flying_block()).save(self.folder / "no/where.json")


INTERRUPTED = """
import apothem, sys, time
sys.path.insert(0, {tests!r})
from support import falling_block, flying_block
document = falling_block() if {contact} else flying_block()
document["time"] = {{"end": 1e6, "step": 1e-4}}
sim = apothem.Simulation(apothem.Scene(document))
if {force}:
    sim.add_force(lambda now, force: sum(range(1000)))
print("running", flush=True)
try:
    sim.run()
except KeyboardInterrupt:
    start, steps = time.monotonic(), sim.steps
    sim.step(10)
    print("interrupted", sim.steps - steps, sim.time < 1e6)
"""


class Interrupts(unittest.TestCase):
    def test_ctrl_c_ends_the_search_for_a_settled_start(self):
        code = ("import apothem\n"
                f"scene = apothem.load({str(SOURCE / 'data/scenes/slope-stands.json')!r},\n"
                "                     set={'contact.friction.law': 'per_edge', 'contact.friction.coefficient': 0.56,\n"
                "                          'contact.damping': {'model': 'normal_viscous', 'ratio': 0.2}})\n"
                "print('settling', flush=True)\n"
                "try:\n    apothem.Simulation(scene)\nexcept KeyboardInterrupt:\n    print('interrupted')\n")
        with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "settling\n")
            time.sleep(1)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.communicate(timeout=20)[0], "interrupted\n")

    def test_python_ends_while_a_thread_runs(self):
        code = ("import threading, time, apothem\n"
                f"sim = apothem.Simulation(apothem.Scene({flying_block(time={'end': 1e9, 'step': 1e-3})!r}))\n"
                "threading.Thread(target=sim.run, daemon=True).start()\n"
                "time.sleep(0.3)\n")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_an_interrupt_comes_before_other_errors_and_only_once(self):
        sim = simulation(flying_block())
        calls = []

        def force(*_):
            calls.append(1)
            if len(calls) == 5:
                raise KeyboardInterrupt

        def after(_):
            if len(calls) == 6:
                raise LookupError

        sim.add_force(force)
        sim.on_step(after)
        with self.assertRaises(KeyboardInterrupt):
            sim.run()
        steps = sim.steps
        self.assertEqual(sim.step(), 1)
        self.assertEqual(sim.steps, steps + 1)

    def test_ctrl_c_ends_a_run_within_a_second(self):
        for contact, force in [(True, False), (False, True)]:
            code = INTERRUPTED.format(tests=os.path.dirname(__file__), contact=contact, force=force)
            with self.subTest(force=force), subprocess.Popen(
                    [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
                self.assertEqual(process.stdout.readline(), "running\n")
                time.sleep(0.5)
                process.send_signal(signal.SIGINT)
                start = time.monotonic()
                self.assertEqual(process.stdout.read(), "interrupted 10 True\n")
                self.assertEqual(process.wait(), 0)
                # The process also has to end; a busy machine gets some time for that.
                self.assertLess(time.monotonic() - start, 5)

    def test_other_threads_run_meanwhile_and_must_not_look(self):
        document = falling_block()
        document["time"] = {"end": 1e6, "step": 1e-4}
        sim = simulation(document)
        refused, counted = [], 0
        sim.on_step(lambda now: done.is_set() and 1 / 0, every=100)
        done = threading.Event()

        def run():
            try:
                sim.run()
            except ZeroDivisionError:
                pass

        thread = threading.Thread(target=run)
        thread.start()
        while len(refused) < 20:
            counted += 1
            try:
                sim.contacts()
            except RuntimeError as error:
                refused.append(str(error))
        done.set()
        thread.join()
        self.assertIn("another thread", refused[0])
        self.assertGreater(sim.steps, 0)
        self.assertGreaterEqual(len(sim.contacts()), 0)


class Processes(unittest.TestCase):
    def test_the_host_is_never_forked(self):
        # The handler of fork runs in every fork of this process; posix_spawn calls none.
        libc = ctypes.CDLL(None)
        forks = []
        handler = ctypes.CFUNCTYPE(None)(lambda: forks.append(1))
        getattr(libc, "__register_atfork")(handler, None, None, None)
        scene = flying_block()
        scene["bodies"][0]["polygon"] = [[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]]
        simulation(scene)
        self.assertEqual(forks, [])
        HANDLERS.append(handler)  # it stays registered
        process = os.fork()
        if process == 0:
            os._exit(0)
        os.waitpid(process, 0)
        self.assertEqual(forks, [1])

    def test_a_helper_that_is_not_there_is_named(self):
        document = flying_block()
        document["bodies"][0]["polygon"] = [[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]]
        os.environ["APOTHEM_SKELETON_PROGRAM"] = "/nowhere/apothem-skeleton"
        self.addCleanup(os.environ.pop, "APOTHEM_SKELETON_PROGRAM")
        with self.assertRaisesRegex(RuntimeError, "/nowhere/apothem-skeleton"):
            simulation(document)


HANDLERS = []


if __name__ == "__main__":
    unittest.main()

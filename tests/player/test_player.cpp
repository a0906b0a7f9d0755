// The page of a run holds what the run wrote: its arrays are read back from the page alone and
// compared with the frames.
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "lib/model/rotation.hpp"
#include "lib/output/run_folder.hpp"
#include "lib/player/data_block.hpp"
#include "tests/folder.hpp"
#include "tests/program.hpp"

using namespace apothem;
using Json = nlohmann::json;
using test::content;
using test::Folder;

namespace {

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned buffer = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    const size_t digit = digits.find(c);
    REQUIRE(digit != std::string::npos);
    buffer = buffer << 6 | static_cast<unsigned>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(buffer >> bits & 0xff);
  }
  return bytes;
}

std::string unpacked(const std::string& text, size_t size) {
  const std::string packed = from_base64(text);
  std::string bytes(size, '\0');
  uLongf length = size;
  REQUIRE(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length,
                     reinterpret_cast<const Bytef*>(packed.data()), packed.size()) == Z_OK);
  REQUIRE(length == size);
  return bytes;
}

using Arrays = std::map<std::string, std::vector<double>>;

// Reads the arrays of a block, as the page does.
Arrays arrays_of(const std::vector<BlockArray>& list, const std::string& bytes) {
  Arrays arrays;
  size_t at = 0;
  for (const BlockArray& a : list) {
    std::vector<std::uint32_t> words(a.count, 0);
    for (int plane = 0; plane < a.planes; ++plane) {
      const int shift = a.real ? 24 - 8 * plane : 8 * plane;
      for (std::uint32_t& word : words) {
        word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at++])) << shift;
      }
    }
    std::vector<double>& values = arrays[a.name];
    for (size_t i = 0; i < words.size(); ++i) {
      if (a.real) {
        values.push_back(std::bit_cast<float>(words[i]));
        continue;
      }
      const auto difference =
          static_cast<std::int32_t>((words[i] >> 1) ^ (words[i] & 1 ? ~0U : 0U));
      values.push_back(difference + (a.period > 0 && i >= a.period ? values[i - a.period] : 0));
    }
  }
  CHECK(at == bytes.size());
  return arrays;
}

std::string between(const std::string& text, const std::string& before, const std::string& after) {
  const size_t begin = text.find(before);
  REQUIRE(begin != std::string::npos);
  const size_t end = text.find(after, begin);
  REQUIRE(end != std::string::npos);
  return text.substr(begin + before.size(), end - begin - before.size());
}

// A page that has been read.
struct Page {
  explicit Page(const std::string& file) {
    const std::string text = content(file);
    description = Json::parse(
        between(text, "<script id=\"description\" type=\"application/json\">", "</script>"));
    std::vector<BlockArray> list;
    for (const Json& a : description["arrays"]) {
      list.push_back({a["name"], a["type"] == "float", a["count"], a["planes"], a["period"]});
    }
    arrays = arrays_of(
        list, unpacked(between(text, "<script id=\"data\" type=\"text/plain\">", "</script>"),
                       description["bytes"]));
    step = description["length_step"];
    origin = Vec2(description["origin"][0].get<double>(), description["origin"][1].get<double>());
  }

  [[nodiscard]] double at(const std::string& name, size_t i) const { return arrays.at(name).at(i); }
  [[nodiscard]] Vec2 place(const std::string& x, const std::string& y, size_t i) const {
    return origin + step * Vec2(at(x, i), at(y, i));
  }
  // The corners of a rigid body in a frame.
  [[nodiscard]] std::vector<Vec2> ring(size_t frame, size_t body) const {
    const size_t i = frame * description["bodies"].size() + body;
    const double angle = double(description["angle_step"]) * at("angle", i);
    std::vector<Vec2> ring;
    const auto first = static_cast<size_t>(at("ring_first", body));
    const auto end = static_cast<size_t>(at("ring_first", body + 1));
    for (size_t c = first; c < end; ++c) {
      ring.push_back(place("x", "y", i) + turned(Vec2(at("ring_x", c), at("ring_y", c)), angle));
    }
    return ring;
  }

  Json description;
  Arrays arrays;
  double step = 0;
  Vec2 origin = Vec2::Zero();
};

// Stones far from the origin that fall onto a bed: one is no convex polygon, one is a mesh, one
// leaves.
constexpr const char* kScene = R"({
  "name": "a <b>", "gravity": [0, -10],
  "materials": { "rock": { "density": 2000, "young": 1e7, "poisson": 0.3 }, "ice": { "density": 900 } },
  "contact": { "normal_stiffness": 1e7, "friction": { "coefficient": 0.5 } },
  "bodies": [
    { "name": "bed", "material": "ice", "motion": "fixed", "polygon": [[999, 0], [1009, 0], [1009, 1], [999, 1]] },
    { "name": "L </script>", "material": "ice", "spin": 3, "velocity": [0, -2],
      "polygon": [[1000, 1.1], [1002, 1.1], [1002, 1.6], [1000.5, 1.6], [1000.5, 3], [1000, 3]] },
    { "name": "stone", "material": "rock", "velocity": [1, 4], "polygon": [[1003, 1.01], [1004, 1.01], [1003.6, 2]] },
    { "name": "sheet", "material": "rock", "velocity": [0, -1],
      "mesh": { "rectangle": { "size": [2, 1], "cells": [4, 2], "origin": [1005, 1.02] } } },
    { "name": "goes", "material": "rock", "velocity": [50, 0], "polygon": [[1008, 5], [1008.5, 5], [1008.5, 6]] }
  ],
  "world": { "box": [[990, -5], [1015, 20]], "outside": "remove" },
  "regions": { "bin": { "polygon": [[999, 0], [1009, 0], [1009, 9], [999, 9]] } },
  "time": { "end": 0.4 },
  "output": { "frames": 8, "history": { "interval": 1e-4 } } })";

}  // namespace

TEST_CASE("a data block gives its arrays back", "[player]") {
  std::mt19937 random(3);
  std::vector<std::int32_t> whole, slow;
  std::vector<float> real, few;
  for (int i = 0; i < 3000; ++i) {
    whole.push_back(static_cast<std::int32_t>(random()));
    slow.push_back(2000000000 + i / 7);
    real.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random()) & 0x7f7fffffU));
    few.push_back(static_cast<float>(i - 1500) / 4);
  }
  DataBlock block;
  block.add("whole", whole);
  block.add("whole differences", whole, 10);
  block.add("slow", slow, 1);
  block.add("real", real);
  block.add("few", few);
  block.add("zeros", std::vector<std::int32_t>(5));
  block.add("nothing", std::vector<float>());
  const Arrays arrays = arrays_of(block.arrays(), unpacked(block.text(), block.size()));
  CHECK(arrays.at("zeros") == std::vector<double>(5));
  CHECK(arrays.at("nothing").empty());
  const auto same = [&](const std::string& name, const auto& values) {
    INFO(name);
    CHECK(arrays.at(name) == std::vector<double>(values.begin(), values.end()));
  };
  same("slow", slow);
  same("real", real);
  same("few", few);
  same("whole", whole);
  CHECK(block.arrays()[2].planes == 4);  // the first one is large
  CHECK(block.arrays()[4].planes == 3);  // the last byte of quarters is 0
  // Differences go around at 2^32, which doubles do not.
  const std::vector<double>& differences = arrays.at("whole differences");
  for (size_t i = 0; i < whole.size(); ++i) {
    CHECK(std::fmod(differences[i] - whole[i], 4294967296.) == 0);
  }
}

TEST_CASE("rounded values are near the values", "[player]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> power(-12, 3), sign(-1, 1);
  const double largest = 1000;
  for (int i = 0; i < 2000; ++i) {
    const double value = std::copysign(std::pow(10, power(random)), sign(random));
    INFO(value);
    CHECK(std::abs(rounded(value, largest) - value) <=
          std::max(5e-4 * std::abs(value), 4e-6 * largest));
  }
  CHECK(rounded(0, 1) == 0);
  CHECK(rounded(1e-9, 1) == 0);
  CHECK(rounded(1000, 1000) == 1000);
}

TEST_CASE("a page holds the frames of its run", "[player]") {
  const Folder folder;
  const std::string scene = folder.write("scene.json", kScene);
  REQUIRE(test::run({"run", scene, "-o", folder / "out", "--quiet"}, folder).code == 0);
  const test::Result done = test::run({"view", folder / "out", "-o", folder / "page.html"}, folder);
  INFO(done.err);
  REQUIRE(done.code == 0);
  CHECK(done.out.find("page.html: 9 frames, 0.") != std::string::npos);
  const Page page(folder / "page.html");
  const RunFolder run(folder / "out");
  CHECK(page.description["times"] == run.times());
  CHECK(page.description["bodies"] == Json({"bed", "L </script>", "stone", "goes", "sheet"}));
  const size_t bodies = 5, items = bodies + 8;
  const Json& quantities = page.description["quantities"];
  CHECK(std::ranges::any_of(quantities,
                            [](const Json& q) { return q["name"] == "s1" && q["unit"] == "kPa"; }));
  bool left = false, pressed = false;
  for (size_t k = 0; k < run.times().size(); ++k) {
    const Frame frame = run.frame(k);
    for (size_t b = 0; b < bodies; ++b) {
      CHECK((page.at("present", k * bodies + b) > 0) == frame.bodies[b].present);
    }
    left = left || !frame.bodies[3].present;
    size_t element = 0;
    for (int e = 0; e < frame.mesh.element_count(); ++e) {
      const auto b = static_cast<size_t>(frame.body[e]);
      const auto nodes = frame.mesh.element(e);
      INFO("frame " << k << ", body " << b);
      if (frame.bodies[b].meshed) {
        const auto first = static_cast<size_t>(page.at("element_first", element));
        REQUIRE(page.at("element_first", element + 1) - double(first) == double(nodes.size()));
        for (size_t c = 0; c < nodes.size(); ++c) {
          const auto node = static_cast<size_t>(page.at("element_nodes", first + c));
          const Vec2 place = page.place("node_x", "node_y", k * 15 + node);
          CHECK((place - frame.position[nodes[c]]).norm() < 0.75 * page.step);
        }
        const double value = page.at("value_s1", k * items + bodies + element);
        const double stress = principal_stresses(frame.stress[e])[0];  // Pa, on the page kPa
        CHECK(1e3 * value == Approx(stress).epsilon(1e-3).margin(1e-5 * 1e7));
        pressed = pressed || stress > 100;
        ++element;
      } else {
        const std::vector<Vec2> ring = page.ring(k, b);
        REQUIRE(ring.size() == nodes.size());
        for (size_t c = 0; c < ring.size(); ++c) {
          CHECK((ring[c] - frame.position[nodes[c]]).norm() < 1.5 * page.step);
        }
      }
      const double coordination = page.at("value_coordination", k * items + b);
      if (b > 0) {
        CHECK(coordination == frame.bodies[b].values[body_quantity("coordination")][0]);
      }
    }
  }
  CHECK(left);
  CHECK(pressed);
  CHECK(page.step < 15. / 131072);  // the first view is 14.5 m wide

  // Chains, by their bodies: loading points, ends and forces.
  size_t i = 0;
  for (size_t k = 0; k < run.times().size(); ++k) {
    CHECK(page.at("chain_first", k) == double(i));
    const Frame frame = run.frame(k);
    std::vector<ForceChain> chains = run.chains(k);
    std::ranges::stable_sort(chains, {},
                             [](const ForceChain& c) { return std::pair(c.body_a, c.body_b); });
    double largest = 0;
    for (const ForceChain& chain : chains) largest = std::max(largest, chain.normal);
    for (const ForceChain& chain : chains) {
      INFO("frame " << k << ", bodies " << chain.body_a << " and " << chain.body_b);
      CHECK(page.at("chain_a", i) == chain.body_a);
      CHECK(page.at("chain_b", i) == chain.body_b);
      const bool from_a = frame.bodies[chain.body_a].motion == Motion::free;
      const bool to_b = frame.bodies[chain.body_b].motion == Motion::free;
      CHECK(page.at("chain_ends", i) == (from_a ? 1 : 0) + (to_b ? 2 : 0));
      const auto near =
          static_cast<size_t>(page.at("chain_near", i) > 0 ? chain.body_b : chain.body_a);
      const Vec2 point = page.place("x", "y", k * bodies + near) +
                         8 * page.step * Vec2(page.at("chain_x", i), page.at("chain_y", i));
      CHECK((chain.line[from_a ? 1 : 0] - point).norm() < 8 * page.step);
      CHECK(page.at("chain_force", i) == Approx(chain.normal).margin(1e-3 * largest));
      ++i;
    }
  }
  CHECK(i > 2);
}

TEST_CASE("nodes of an element that becomes concave stay apart", "[player]") {
  const Folder folder;
  folder.write("two.msh",
               "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 1 1 0\n"
               "4 0 1 0\n5 2 0 0\n6 2 1 0\n$EndNodes\n$Elements\n2\n1 3 2 1 1 1 2 3 4\n"
               "2 3 2 1 1 5 6 3 2\n$EndElements\n");
  const std::string scene = folder.write("scene.json", R"({
    "name": "dent", "materials": { "r": { "density": 1000, "young": 1e4, "poisson": 0, "law": "neo_hookean" } },
    "contact": { "normal_stiffness": 1e4 },
    "bodies": [ { "name": "q", "material": "r", "mesh": { "file": "two.msh", "element": "Q4" },
                  "supports": [ { "where": { "x": 0 }, "fix": ["x", "y"] },
                                { "where": { "x": 1 }, "fix": ["x", "y"] } ],
                  "loads": [ { "at": [2, 1], "force": [-2500, -2500],
                               "history": [[0, 0], [0.2, 1], [1e9, 1]] } ] } ],
    "time": { "end": 0.5 }, "output": { "frames": 20 } })");
  const test::Result done = test::run({"run", scene, "-o", folder / "out", "--quiet"}, folder);
  INFO(done.err);
  REQUIRE(done.code == 0);
  REQUIRE(test::run({"view", folder / "out", "-o", folder / "page.html"}, folder).code == 0);
  const Page page(folder / "page.html");
  const RunFolder run(folder / "out");
  bool concave = false;
  for (size_t k = 0; k < run.times().size(); ++k) {
    const Frame frame = run.frame(k);
    REQUIRE(frame.position.size() == 6);
    for (size_t n = 0; n < 6; ++n) {
      INFO("frame " << k << ", node " << n);
      CHECK((page.place("node_x", "node_y", 6 * k + n) - frame.position[n]).norm() <
            0.75 * page.step);
    }
    concave = concave || frame.mesh.element(1)[0] != run.frame(0).mesh.element(1)[0];
  }
  CHECK(concave);
}

TEST_CASE("plots of a page hold the extremes of many rows", "[player]") {
  const Folder folder;
  const std::string scene = folder.write("scene.json", kScene);
  REQUIRE(test::run({"run", scene, "-o", folder / "out", "--quiet"}, folder).code == 0);
  REQUIRE(test::run({"view", folder / "out"}, folder).code == 0);
  const Page page(folder / "out/view.html");
  const HistoryTable table = RunFolder(folder / "out").table("energy.csv");
  REQUIRE(table.columns[0].size() > 3000);
  const Json& energy = page.description["plots"][0];
  CHECK(energy["title"] == "Energy");
  const Json& line = energy["choices"][0]["lines"][0];
  CHECK(line["label"] == "kinetic");
  const auto column = [&](const char* key) {
    return page.arrays.at("column_" + std::to_string(int(line[key])));
  };
  const std::vector<double> times = column("time"), values = column("column");
  CHECK(times.size() == 2000);
  CHECK(values.size() == 2000);
  CHECK(std::is_sorted(times.begin(), times.end()));
  const std::vector<double>& kinetic = *table.column("kinetic");
  for (const auto extreme : {std::max_element<std::vector<double>::const_iterator>,
                             std::min_element<std::vector<double>::const_iterator>}) {
    CHECK(*extreme(values.begin(), values.end()) ==
          Approx(*extreme(kinetic.begin(), kinetic.end())).epsilon(1e-6));
  }
  CHECK(page.description["plots"][1]["title"] == "Regions");
}

TEST_CASE("what cannot be viewed is refused", "[player]") {
  const Folder folder;
  const auto refused = [&](const std::vector<std::string>& words, const std::string& why) {
    const test::Result result = test::run(words, folder);
    CHECK(result.code == 2);
    CHECK(result.err.find(why) != std::string::npos);
    CHECK(test::lines(result.err) == 1);
  };
  refused({"view", folder / "missing"}, "missing: there is no such folder");
  std::filesystem::create_directories(folder / "empty");
  refused({"view", folder / "empty"}, "frames.pvd: there is no such file");
  refused({"view", folder / "empty", "-o", folder / "page.png"}, "a name that ends with .html");
  CHECK(!std::filesystem::exists(folder / "empty/view.html"));
  refused({"view", folder / "empty", "--movie", folder / "movie.avi"}, "must end in .mp4 or .gif");
  refused({"view", folder / "empty", "--chains"}, "--movie");
  refused({"view", folder / "empty", "--range", "0,1"}, "--movie");
}

namespace {

// Sets a variable of the environment for a while.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name), before_(std::getenv(name)) {
    setenv(name, value, 1);
  }
  ~Variable() { setenv(name_, before_.c_str(), 1); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::string before_;
};

std::string output_of(const std::string& command, const Folder& folder) {
  const std::string file = folder / "command.txt";
  REQUIRE(std::system((command + " > " + file + " 2>/dev/null").c_str()) == 0);
  return content(file);
}

}  // namespace

TEST_CASE("a movie has all frames of its run", "[player][slow]") {
  const Folder folder;
  const std::string scene = folder.write("scene.json", kScene);
  REQUIRE(test::run({"run", scene, "-o", folder / "out", "--quiet"}, folder).code == 0);
  const auto movie = [&](const std::string& name) {
    return test::run({"view", folder / "out", "--movie", folder / name, "--chains", "--rate", "5",
                      "--range", "0,1"},
                     folder);
  };
  {
    const Variable path("PATH", "/nowhere");
    const test::Result result = movie("movie.mp4");
    CHECK(result.code == 2);
    CHECK(result.err.find("it is not installed; on Debian: apt-get install ffmpeg") !=
          std::string::npos);
    CHECK(!std::filesystem::exists(folder / "movie.mp4"));
  }
  if (std::system("ffprobe -version > /dev/null 2>&1") != 0) {
    WARN("ffmpeg is not installed: no movie was made");
    return;
  }
  for (const char* name : {"movie.mp4", "movie.gif"}) {
    const test::Result result = movie(name);
    INFO(name << ": " << result.err);
    REQUIRE(result.code == 0);
    const std::string found = output_of(
        "ffprobe -v error -count_frames -select_streams v -show_entries "
        "stream=width,height,r_frame_rate,nb_read_frames -of default=nw=1 " +
            (folder / name),
        folder);
    INFO(found);
    CHECK(found.find("nb_read_frames=9\n") != std::string::npos);
    CHECK(found.find("r_frame_rate=5/1\n") != std::string::npos);
    const int height = std::stoi(found.substr(found.find("height=") + 7));
    CHECK(height > 200);
  }
}

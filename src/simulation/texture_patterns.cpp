#include "texture_patterns.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

// A board with grain, knots and two nails at each end.
void paintBoard(double left, double top, double right, double bottom, double gray, Canvas* canvas,
                Random* random) {
  canvas->rectangle(left, top, right, bottom, gray);
  const double height = bottom - top;
  for (int i = 0; i < 5; ++i) {
    const double y = random->uniform(top + 0.05 * height, bottom - 0.05 * height);
    const double begin = random->uniform(left, right);
    const double end = std::min(right, begin + random->uniform(0.1, 0.5));
    canvas->line(begin, y, end, y + random->uniform(-0.05, 0.05) * height, 0.003,
                 gray + random->uniform(-26.0, 14.0));
  }
  if (random->chance(0.6)) {
    const double x = random->uniform(left, right);
    const double y = random->uniform(top + 0.3 * height, bottom - 0.3 * height);
    const double radius = std::min(0.22 * height, random->uniform(0.006, 0.02));
    canvas->circle(x, y, radius, gray - 40.0);
    canvas->circle(x, y, 0.5 * radius, gray - 15.0);
  }
  for (const double x : {left + 0.02, right - 0.02}) {
    canvas->circle(x, top + 0.2 * height, 0.004, gray - 60.0);
    canvas->circle(x, bottom - 0.2 * height, 0.004, gray - 60.0);
  }
}

// Frames within frames; large fields are divided further.
void paintPanel(double left, double top, double right, double bottom, double gray, int depth,
                Canvas* canvas, Random* random) {
  const double width = right - left;
  const double height = bottom - top;
  if (depth > 0 && std::max(width, height) > 0.25) {
    const double cut = random->uniform(0.3, 0.7);
    const double other = gray + random->uniform(-28.0, 28.0);
    if (width > height) {
      paintPanel(left, top, left + cut * width, bottom, gray, depth - 1, canvas, random);
      paintPanel(left + cut * width, top, right, bottom, other, depth - 1, canvas, random);
    } else {
      paintPanel(left, top, right, top + cut * height, gray, depth - 1, canvas, random);
      paintPanel(left, top + cut * height, right, bottom, other, depth - 1, canvas, random);
    }
    return;
  }
  canvas->rectangle(left, top, right, bottom, gray);
  canvas->frame(left, top, right, bottom, 0.006, gray - 45.0);
  const double inset = 0.12 * std::min(width, height);
  canvas->frame(left + inset, top + inset, right - inset, bottom - inset, 0.01,
                gray + random->uniform(-50.0, 40.0));
  if (random->chance(0.5)) {
    canvas->circle(right - 0.5 * inset, 0.5 * (top + bottom), std::min(0.02, 0.3 * inset),
                   gray - 80.0);
  }
}

// A diamond, a triangle or a ring within a square field.
void paintMotif(double x, double y, double size, double gray, Canvas* canvas, Random* random) {
  const double half = 0.5 * size;
  switch (random->integer(0, 3)) {
    case 0:
      canvas->polygon({{x - half, y}, {x, y - half}, {x + half, y}, {x, y + half}}, gray);
      break;
    case 1:
      canvas->polygon({{x - half, y + half},
                       {x + random->uniform(-half, half), y - half},
                       {x + half, y + half}},
                      gray);
      break;
    case 2:
      canvas->circle(x, y, half, gray);
      canvas->circle(x, y, 0.6 * half, gray + (gray > 128.0 ? -70.0 : 70.0));
      break;
    default:
      canvas->rectangle(x - half, y - 0.5 * half, x + half, y + 0.5 * half, gray);
      canvas->rectangle(x - 0.3 * half, y - half, x + 0.3 * half, y + half, gray);
  }
}

}  // namespace

void paintPlain(double gray, Canvas* canvas, Random* random) {
  canvas->frame(0.0, 0.0, canvas->width(), canvas->height(), 0.01, gray - 25.0);
  canvas->speckles(6.0, 25.0, random);
}

void paintPlaster(double gray, Canvas* canvas, Random* random) {
  const double width = canvas->width();
  const double height = canvas->height();
  canvas->rectangle(0.0, 0.62 * height, width, height, gray - 24.0);  // darker below a rail
  canvas->rectangle(0.0, 0.62 * height - 0.05, width, 0.62 * height, gray - 60.0);
  canvas->rectangle(0.0, height - 0.12, width, height, gray - 75.0);  // skirting board
  canvas->rectangle(0.0, height - 0.03, width, height, gray - 40.0);
  for (int i = 0; i < static_cast<int>(1.5 * width); ++i) {  // sockets, hooks
    const double x = random->uniform(0.1, width - 0.2);
    const double y = random->chance(0.5) ? height - 0.35 : random->uniform(0.3, 0.6) * height;
    canvas->rectangle(x, y, x + 0.085, y + 0.085, gray + 45.0);
    canvas->frame(x, y, x + 0.085, y + 0.085, 0.006, gray - 60.0);
    canvas->circle(x + 0.025, y + 0.042, 0.008, gray - 90.0);
    canvas->circle(x + 0.06, y + 0.042, 0.008, gray - 90.0);
  }
  for (int i = 0; i < static_cast<int>(1.2 * width); ++i) {  // cracks
    double x = random->uniform(0.0, width);
    double y = random->uniform(0.0, 0.55 * height);
    for (int k = 0; k < 6; ++k) {
      const double next_x = x + random->uniform(-0.08, 0.08);
      const double next_y = y + random->uniform(0.0, 0.09);
      canvas->line(x, y, next_x, next_y, 0.004, gray - 45.0);
      x = next_x;
      y = next_y;
    }
  }
  canvas->speckles(22.0, 45.0, random);
}

void paintBricks(double gray, Canvas* canvas, Random* random) {
  const double mortar = 0.012;
  for (double y = 0.0; y < canvas->height();) {
    const double height = random->uniform(0.09, 0.15);
    for (double x = -random->uniform(0.0, 0.3); x < canvas->width();) {
      const double width = random->uniform(0.18, 0.42);
      const double shade = gray - 12.0 + 24.0 * random->normal();
      canvas->rectangle(x, y, x + width - mortar, y + height - mortar, shade);
      canvas->rectangle(x, y + height - 2.0 * mortar, x + width - mortar, y + height - mortar,
                        shade - 18.0);
      x += width;
    }
    y += height;
  }
  canvas->speckles(40.0, 40.0, random);
}

void paintPanels(double gray, Canvas* canvas, Random* random) {
  const double longest = std::max(canvas->width(), canvas->height());
  const int depth = longest > 3.0 ? 7 : longest > 1.0 ? 4 : 2;
  paintPanel(0.0, 0.0, canvas->width(), canvas->height(), gray, depth, canvas, random);
  canvas->speckles(14.0, 35.0, random);
}

void paintPlanks(double gray, Canvas* canvas, Random* random) {
  for (double y = 0.0; y < canvas->height();) {
    const double height = random->uniform(0.09, 0.15);
    for (double x = -random->uniform(0.0, 1.0); x < canvas->width();) {
      const double length = random->uniform(0.5, 1.4);
      paintBoard(x, y, x + length - 0.006, y + height - 0.006, gray + 20.0 * random->normal(),
                 canvas, random);
      canvas->rectangle(x + length - 0.006, y, x + length, y + height, gray - 70.0);
      x += length;
    }
    canvas->rectangle(0.0, y + height - 0.006, canvas->width(), y + height, gray - 70.0);
    y += height;
  }
  canvas->speckles(8.0, 30.0, random);
}

void paintTiles(double gray, Canvas* canvas, Random* random) {
  const double size = canvas->width() > 1.0 ? 0.5 : 0.17;
  const double joint = 0.04 * size;
  for (double y = 0.0; y < canvas->height(); y += size) {
    for (double x = 0.0; x < canvas->width(); x += size) {
      const double shade = gray + 12.0 * random->normal();
      canvas->rectangle(x, y, x + size - joint, y + size - joint, shade);
      canvas->rectangle(x + size - joint, y, x + size, y + size, gray - 60.0);
      canvas->rectangle(x, y + size - joint, x + size, y + size, gray - 60.0);
      if (random->chance(0.45)) {
        const double motif = size * random->uniform(0.2, 0.6);
        paintMotif(x + size * random->uniform(0.35, 0.6), y + size * random->uniform(0.35, 0.6),
                   motif, shade - random->uniform(25.0, 80.0), canvas, random);
      }
    }
  }
  canvas->speckles(10.0, 35.0, random);
}

void paintCarpet(double gray, Canvas* canvas, Random* random) {
  const double width = canvas->width();
  const double height = canvas->height();
  const double tones[] = {gray - 65.0, gray + 60.0, gray - 25.0};
  for (int band = 0; band < 3; ++band) {
    const double inset = 0.02 + 0.07 * band;
    canvas->frame(inset, inset, width - inset, height - inset, 0.04, tones[band]);
  }
  const int motifs = static_cast<int>(45.0 * width * height);
  for (int i = 0; i < motifs; ++i) {
    const double size = 0.05 * std::pow(7.0, random->uniform());
    paintMotif(random->uniform(0.3, width - 0.3), random->uniform(0.3, height - 0.3), size,
               gray + random->uniform(-75.0, 75.0), canvas, random);
  }
  canvas->speckles(60.0, 30.0, random);
}

void paintBooks(double gray, Canvas* canvas, Random* random) {
  const double board = 0.025;
  for (double y = 0.0; y < canvas->height() - 0.05;) {
    const double shelf = std::min(random->uniform(0.26, 0.38), canvas->height() - y);
    canvas->rectangle(0.0, y, canvas->width(), y + shelf, 28.0);
    for (double x = 0.01; x < canvas->width() - 0.02;) {
      const double width = std::min(random->uniform(0.02, 0.065), canvas->width() - x);
      const double top = y + shelf - board - (shelf - board) * random->uniform(0.6, 0.93);
      const double shade = gray + random->uniform(-95.0, 95.0);
      const double ink = shade > 120.0 ? shade - 85.0 : shade + 85.0;
      canvas->rectangle(x, top, x + width - 0.003, y + shelf - board, shade);
      canvas->rectangle(x, top + 0.02, x + width - 0.003, top + 0.03, ink);
      if (width > 0.03) {
        canvas->text(randomLetters(random->integer(3, 7), random), x + 0.3 * width, top + 0.045,
                     0.4 * width, ink, true);
      }
      x += random->chance(0.07) ? width + 0.06 : width;
    }
    canvas->rectangle(0.0, y + shelf - board, canvas->width(), y + shelf, 95.0);
    y += shelf;
  }
}

void paintCrate(double gray, Canvas* canvas, Random* random) {
  const double width = canvas->width();
  const double height = canvas->height();
  const double rail = 0.12 * std::min(width, height);
  paintPlanks(gray, canvas, random);
  canvas->polygon({{rail, 0.5 * rail},
                   {width - 0.5 * rail, height - rail},
                   {width - rail, height},
                   {0.0, rail}},
                  gray + 22.0);
  for (int side = 0; side < 2; ++side) {
    paintBoard(0.0, side * (height - rail), width, side * (height - rail) + rail,
               gray + random->uniform(-25.0, 35.0), canvas, random);
  }
  canvas->rectangle(0.0, 0.0, rail, height, gray + 30.0);
  canvas->rectangle(width - rail, 0.0, width, height, gray + 15.0);
  canvas->frame(0.0, 0.0, width, height, 0.008, gray - 60.0);
  canvas->text(randomLetters(4, random), 0.25 * width, 0.62 * height, 0.16 * height, gray - 85.0);
  canvas->text(randomLetters(8, random), 0.27 * width, 0.76 * height, 0.06 * height, gray - 70.0);
}

void paintPoster(double gray, Canvas* canvas, Random* random) {
  const double width = canvas->width();
  const double height = canvas->height();
  const double side = std::min(width, height);
  for (int i = 0; i < 26; ++i) {
    const double size = side * 0.55 * std::pow(0.88, i) * random->uniform(0.7, 1.3);
    const double x = random->uniform(0.0, width);
    const double y = random->uniform(0.0, 0.8 * height);
    const double shade = random->uniform(20.0, 235.0);
    if (i % 4 == 3) {  // stripes
      for (int k = 0; k < 5; ++k) {
        canvas->rectangle(x + 0.2 * k * size, y, x + (0.2 * k + 0.09) * size,
                          y + size * random->uniform(0.4, 0.8), shade);
      }
    } else {
      paintMotif(x, y, size, shade, canvas, random);
    }
  }
  const double base = 0.76 * height;  // a field with writing below the picture
  const double paper = gray > 128.0 ? 238.0 : 40.0;
  const double ink = gray > 128.0 ? 35.0 : 215.0;
  canvas->rectangle(0.0, base, width, height, paper);
  canvas->text(randomLetters(6, random), 0.06 * width, base + 0.12 * height, 0.08 * height, ink);
  canvas->text(randomLetters(17, random), 0.06 * width, base + 0.17 * height, 0.026 * height, ink);
  canvas->text(randomLetters(24, random), 0.06 * width, base + 0.21 * height, 0.018 * height, ink);
  canvas->frame(0.0, 0.0, width, height, 0.025 * side, random->chance(0.5) ? 18.0 : 240.0);
}

}  // namespace camera_self_calibration

#include "camera_self_calibration/simulation/texture_paint.h"

#include <algorithm>

#include "texture_patterns.h"

namespace camera_self_calibration {
namespace {

constexpr double kLargestSide = 4096.0;  // [texel]

// Contrast of the clouds that cover a surface: large where little else is seen.
double cloudContrast(TextureKind kind) {
  switch (kind) {
    case TextureKind::kPlain:
      return 4.0;
    case TextureKind::kPlaster:
      return 9.0;
    case TextureKind::kPoster:
    case TextureKind::kBooks:
      return 2.0;
    default:
      return 6.0;
  }
}

void paint(const TextureRecipe& recipe, Canvas* canvas, Random* random) {
  switch (recipe.kind) {
    case TextureKind::kPlain:
      return paintPlain(recipe.gray, canvas, random);
    case TextureKind::kPlaster:
      return paintPlaster(recipe.gray, canvas, random);
    case TextureKind::kBricks:
      return paintBricks(recipe.gray, canvas, random);
    case TextureKind::kPanels:
      return paintPanels(recipe.gray, canvas, random);
    case TextureKind::kPlanks:
      return paintPlanks(recipe.gray, canvas, random);
    case TextureKind::kTiles:
      return paintTiles(recipe.gray, canvas, random);
    case TextureKind::kCarpet:
      return paintCarpet(recipe.gray, canvas, random);
    case TextureKind::kPoster:
      return paintPoster(recipe.gray, canvas, random);
    case TextureKind::kBooks:
      return paintBooks(recipe.gray, canvas, random);
    case TextureKind::kCrate:
      return paintCrate(recipe.gray, canvas, random);
    case TextureKind::kImage:
      return;  // needs no painting
  }
}

}  // namespace

cv::Mat paintTexture(const TextureRecipe& recipe, double width_m, double height_m) {
  if (recipe.kind == TextureKind::kImage) return recipe.image;
  const double density =
      std::min(recipe.texels_per_metre, kLargestSide / std::max(width_m, height_m));
  Random random(recipe.seed);
  Canvas canvas(width_m, height_m, density, recipe.gray);
  paint(recipe, &canvas, &random);
  return canvas.finish(cloudContrast(recipe.kind), &random);
}

}  // namespace camera_self_calibration

#include "drivers/files/exports/export.hpp"

#include "drivers/files/exports/export_table.hpp"

namespace kolsky {

void export_shot(const Shot& shot, const Reduction& reduction, ExportFormat format,
                 const std::filesystem::path& path) {
  switch (format) {
    case ExportFormat::csv:
      return export_csv(shot, reduction, path);
    case ExportFormat::mat:
      return export_mat(shot, reduction, path);
    case ExportFormat::hdf5:
      return export_hdf5(shot, reduction, path);
  }
}

}  // namespace kolsky

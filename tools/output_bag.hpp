// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include <rosbag/bag.h>

#include "output_files.hpp"

namespace fdp_stereo {

/// A bag that gets its name when it is finished, and leaves nothing where it is not.
class OutputBag {
 public:
  explicit OutputBag(const std::string& path)
      : file_(path), bag_(new rosbag::Bag(file_.partial(), rosbag::bagmode::Write)) {}

  rosbag::Bag& operator*() { return *bag_; }
  rosbag::Bag* operator->() { return bag_.get(); }
  void finish() {
    bag_->close();
    file_.finish();
  }

 private:
  /// Closing throws where the disk is full, and the destructor of a bag that is open closes it: it is left alone then.
  struct Close {
    void operator()(rosbag::Bag* bag) const {
      try {
        bag->close();
      } catch (const rosbag::BagException&) {
        return;
      }
      delete bag;
    }
  };

  PartialFile file_;
  std::unique_ptr<rosbag::Bag, Close> bag_;
};

}  // namespace fdp_stereo
